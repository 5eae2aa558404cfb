//! Actions of keys and mouse: one table for the window, its help and docs/preview.md.

use std::f64::consts::PI;

use eframe::egui::{self, Key};

use super::session::Action;
use super::view::View;

/// Effect of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// An action on the scene or the image.
    Act(Action),
    /// Shows or hides the help.
    Help,
    /// Shows or hides the settings.
    Panel,
    /// Closes the window.
    Close,
}

/// A key with its modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chord {
    /// The key.
    pub key: Key,
    /// True if Ctrl (Command on a Mac) is held.
    pub control: bool,
    /// Required state of Shift; `None` accepts both, for keys whose sign may need Shift.
    pub shift: Option<bool>,
}

/// A row of the table.
pub struct Line {
    /// Names of the keys or mouse actions.
    pub keys: &'static str,
    /// Description of their effect.
    pub what: &'static str,
    /// Key bindings; empty for the mouse.
    pub bindings: &'static [(Chord, Command)],
}

const fn plain(key: Key) -> Chord {
    Chord { key, control: false, shift: Some(false) }
}

const fn sign(key: Key) -> Chord {
    Chord { key, control: false, shift: None }
}

const fn shift(key: Key) -> Chord {
    Chord { key, control: false, shift: Some(true) }
}

const fn control(key: Key) -> Chord {
    Chord { key, control: true, shift: None }
}

const fn mouse(keys: &'static str, what: &'static str) -> Line {
    Line { keys, what, bindings: &[] }
}

const STEP: f64 = PI / 36.0;
const SHIFT: f64 = 0.02;

/// All key bindings and mouse actions.
pub const TABLE: &[Line] = &[
    mouse("drag", "orbit the camera about its target"),
    mouse("right drag, Shift drag", "pan the camera"),
    mouse("wheel", "move the camera nearer or farther"),
    mouse("click", "focus there"),
    mouse("drag the line", "move the line between two images"),
    Line {
        keys: "arrows",
        what: "orbit the camera",
        bindings: &[
            (plain(Key::ArrowLeft), Command::Act(Action::Orbit(-STEP, 0.0))),
            (plain(Key::ArrowRight), Command::Act(Action::Orbit(STEP, 0.0))),
            (plain(Key::ArrowUp), Command::Act(Action::Orbit(0.0, STEP))),
            (plain(Key::ArrowDown), Command::Act(Action::Orbit(0.0, -STEP))),
        ],
    },
    Line {
        keys: "Shift arrows",
        what: "pan the camera",
        bindings: &[
            (shift(Key::ArrowLeft), Command::Act(Action::Pan(SHIFT, 0.0))),
            (shift(Key::ArrowRight), Command::Act(Action::Pan(-SHIFT, 0.0))),
            (shift(Key::ArrowUp), Command::Act(Action::Pan(0.0, SHIFT))),
            (shift(Key::ArrowDown), Command::Act(Action::Pan(0.0, -SHIFT))),
        ],
    },
    Line {
        keys: "Page Up, Page Down",
        what: "move the camera nearer, farther",
        bindings: &[
            (plain(Key::PageUp), Command::Act(Action::Dolly(1.0 / 1.1))),
            (plain(Key::PageDown), Command::Act(Action::Dolly(1.1))),
        ],
    },
    Line {
        keys: "Home",
        what: "reset the camera to the scene file",
        bindings: &[(plain(Key::Home), Command::Act(Action::Home))],
    },
    Line {
        keys: "[ ]",
        what: "close, open the lens",
        bindings: &[
            (sign(Key::OpenBracket), Command::Act(Action::Aperture(0.8))),
            (sign(Key::CloseBracket), Command::Act(Action::Aperture(1.25))),
        ],
    },
    Line {
        keys: "- +",
        what: "exposure down, up by a third of a stop",
        bindings: &[
            (sign(Key::Minus), Command::Act(Action::Expose(-1.0 / 3.0))),
            (sign(Key::Plus), Command::Act(Action::Expose(1.0 / 3.0))),
            (sign(Key::Equals), Command::Act(Action::Expose(1.0 / 3.0))),
        ],
    },
    Line {
        keys: "T",
        what: "next tone map",
        bindings: &[(plain(Key::T), Command::Act(Action::ToneMap))],
    },
    Line {
        keys: "1 to 9, 0",
        what: "views: picture, direct, caustic, indirect, albedo, normal, depth, radius, photons, \
               variance",
        bindings: &[
            (plain(Key::Num1), Command::Act(Action::View(View::Picture))),
            (plain(Key::Num2), Command::Act(Action::View(View::Direct))),
            (plain(Key::Num3), Command::Act(Action::View(View::Caustic))),
            (plain(Key::Num4), Command::Act(Action::View(View::Indirect))),
            (plain(Key::Num5), Command::Act(Action::View(View::Albedo))),
            (plain(Key::Num6), Command::Act(Action::View(View::Normal))),
            (plain(Key::Num7), Command::Act(Action::View(View::Depth))),
            (plain(Key::Num8), Command::Act(Action::View(View::Radius))),
            (plain(Key::Num9), Command::Act(Action::View(View::Photons))),
            (plain(Key::Num0), Command::Act(Action::View(View::Variance))),
        ],
    },
    Line {
        keys: "; '",
        what: "start radius smaller, larger",
        bindings: &[
            (sign(Key::Semicolon), Command::Act(Action::Radius(0.8))),
            (sign(Key::Quote), Command::Act(Action::Radius(1.25))),
        ],
    },
    Line {
        keys: "A",
        what: "automatic start radius",
        bindings: &[(plain(Key::A), Command::Act(Action::AutoRadius))],
    },
    Line {
        keys: "R",
        what: "next radius rule",
        bindings: &[(plain(Key::R), Command::Act(Action::Rule))],
    },
    Line {
        keys: ", .",
        what: "halve, double the photons per pass",
        bindings: &[
            (sign(Key::Comma), Command::Act(Action::Photons(0.5))),
            (sign(Key::Period), Command::Act(Action::Photons(2.0))),
        ],
    },
    Line {
        keys: "D",
        what: "direct light by shadow rays or by photons",
        bindings: &[(plain(Key::D), Command::Act(Action::Direct))],
    },
    Line {
        keys: "Space",
        what: "pause, continue",
        bindings: &[(plain(Key::Space), Command::Act(Action::Pause))],
    },
    Line {
        keys: "K",
        what: "keep this image to compare the next ones with it, or drop it",
        bindings: &[(plain(Key::K), Command::Act(Action::Keep))],
    },
    Line {
        keys: "B",
        what: "show the other image side by side, or hide it",
        bindings: &[(plain(Key::B), Command::Act(Action::Split))],
    },
    Line {
        keys: "S",
        what: "save the image",
        bindings: &[(plain(Key::S), Command::Act(Action::SavePicture))],
    },
    Line {
        keys: "Ctrl S",
        what: "save camera and settings into the scene file",
        bindings: &[(control(Key::S), Command::Act(Action::SaveScene))],
    },
    Line {
        keys: "H",
        what: "hide or show the settings",
        bindings: &[(plain(Key::H), Command::Panel)],
    },
    Line {
        keys: "? or F1",
        what: "this help",
        bindings: &[
            (sign(Key::Questionmark), Command::Help),
            (shift(Key::Slash), Command::Help),
            (plain(Key::F1), Command::Help),
        ],
    },
    Line { keys: "Ctrl Q", what: "close", bindings: &[(control(Key::Q), Command::Close)] },
];

/// Commands of the keys pressed in this frame.
pub fn pressed(input: &egui::InputState) -> Vec<Command> {
    let down = |event: &egui::Event| match event {
        egui::Event::Key { key, pressed: true, modifiers, .. } => command(*key, *modifiers),
        _ => None,
    };
    input.events.iter().filter_map(down).collect()
}

fn command(key: Key, modifiers: egui::Modifiers) -> Option<Command> {
    let meant = |chord: &Chord| {
        chord.key == key
            && chord.control == modifiers.command
            && chord.shift.is_none_or(|shift| shift == modifiers.shift)
    };
    let mut all = TABLE.iter().flat_map(|line| line.bindings);
    all.find(|(chord, _)| meant(chord)).map(|(_, command)| *command)
}

/// The table in Markdown, as it appears in docs/preview.md.
pub fn markdown() -> String {
    let line = |line: &Line| format!("| {} | {} |\n", line.keys, line.what);
    format!("| keys, mouse | what |\n|---|---|\n{}", TABLE.iter().map(line).collect::<String>())
}

/// Theory: no chord has two meanings, and the documentation contains the current table.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_are_not_ambiguous() {
        let all: Vec<&(Chord, Command)> = TABLE.iter().flat_map(|line| line.bindings).collect();
        for (i, (a, _)) in all.iter().enumerate() {
            for (b, _) in &all[..i] {
                let shifts = a.shift.zip(b.shift).is_none_or(|(a, b)| a == b);
                assert!(!(a.key == b.key && a.control == b.control && shifts), "{a:?}");
            }
        }
        let save =
            |command| self::command(Key::S, egui::Modifiers { command, ..Default::default() });
        assert_eq!(save(false), Some(Command::Act(Action::SavePicture)));
        assert_eq!(save(true), Some(Command::Act(Action::SaveScene)));
        assert_eq!(self::command(Key::Z, egui::Modifiers::NONE), None);
        let views = View::ALL.map(|view| Command::Act(Action::View(view)));
        assert!(views.iter().all(|view| all.iter().any(|(_, command)| command == view)));
        let line = TABLE.iter().find(|line| line.keys == "1 to 9, 0").unwrap();
        assert_eq!(line.what, format!("views: {}", View::ALL.map(View::word).join(", ")));
    }

    #[test]
    fn documentation_has_the_table() {
        let page = std::fs::read_to_string("docs/preview.md").unwrap();
        assert!(page.contains(&markdown()), "docs/preview.md lacks:\n{}", markdown());
        assert!(!page.contains(&markdown().replace("Ctrl Q", "Ctrl X")));
    }
}
