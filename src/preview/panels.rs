//! The settings panel, the status lines and the help.

use std::fmt::Debug;

use eframe::egui::{self, ComboBox, DragValue, Grid, RichText, ScrollArea, Ui};

use super::frame::Frame;
use super::keys::{Command, TABLE};
use super::session::{Action, Session};
use super::view::{Scale, View};
use crate::device::{self, Wanted};
use crate::film::Picture;
use crate::scene::settings::{Direct, Method, Radius, RadiusRule};
use crate::scene::{Camera, Projection, ToneMap};

/// Range of the lengths that the panel can set.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// Shows the settings; returns the commands of the buttons that were pressed.
pub fn settings(ui: &mut Ui, session: &mut Session) -> Vec<Command> {
    let mut asked = Vec::new();
    ScrollArea::vertical().show(ui, |ui| {
        ui.add_space(4.0);
        section(ui, "Image", |ui| picture(ui, session));
        section(ui, "Render", |ui| render(ui, session));
        section(ui, "Camera", |ui| camera(ui, session));
        ui.separator();
        ui.horizontal_wrapped(|ui| {
            let mut button = |text: &str, command| {
                if ui.button(text).clicked() {
                    asked.push(command);
                }
            };
            button("Save image", Command::Act(Action::SavePicture));
            button("Save scene", Command::Act(Action::SaveScene));
            button(if session.paused { "Continue" } else { "Pause" }, Command::Act(Action::Pause));
            button("Reset camera", Command::Act(Action::Home));
            button("Help", Command::Help);
        });
        if session.is_edited() {
            ui.weak("Some changes are not in the scene file.");
        }
    });
    asked
}

fn section(ui: &mut Ui, title: &str, rows: impl FnOnce(&mut Ui)) {
    ui.strong(title);
    Grid::new(title).num_columns(2).spacing([8.0, 4.0]).min_col_width(72.0).show(ui, rows);
    ui.add_space(8.0);
}

fn row(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    ui.label(name);
    add(ui);
    ui.end_row();
}

fn choice<T: Copy + PartialEq + Debug>(ui: &mut Ui, id: &str, of: &mut T, all: &[(T, &str)]) {
    let now = all.iter().find(|(value, _)| value == of).map_or("", |(_, word)| word);
    ComboBox::from_id_salt(id).selected_text(now).width(110.0).show_ui(ui, |ui| {
        for (value, word) in all {
            ui.selectable_value(of, *value, *word);
        }
    });
}

fn picture(ui: &mut Ui, session: &mut Session) {
    let views = View::ALL.map(|view| (view, view.word()));
    row(ui, "view", |ui| choice(ui, "view", &mut session.view, &views));
    let film = &mut session.now.film;
    row(ui, "exposure", |ui| {
        ui.add(
            DragValue::new(&mut film.exposure)
                .speed(0.05)
                .range(-30.0..=30.0)
                .max_decimals(2)
                .suffix(" stops"),
        );
    });
    row(ui, "tone map", |ui| {
        choice(
            ui,
            "tone map",
            &mut film.tonemap,
            &[(ToneMap::Agx, "AgX"), (ToneMap::Srgb, "sRGB")],
        );
    });
    if let Some(comparison) = &session.comparison {
        row(ui, "compare with", |ui| {
            ui.label(&comparison.name);
        });
    }
}

fn render(ui: &mut Ui, session: &mut Session) {
    row(ui, "device", |ui| device(ui, &mut session.device));
    let settings = &mut session.now.settings;
    let methods = [(Method::Sppm, "SPPM"), (Method::Ppm, "PPM"), (Method::Path, "path tracing")];
    row(ui, "method", |ui| choice(ui, "method", &mut settings.method, &methods));
    row(ui, "passes", |ui| {
        ui.add(DragValue::new(&mut settings.passes).range(1..=u32::MAX).speed(1.0));
    });
    row(ui, "photons", |ui| {
        let speed = 0.01 * f64::from(settings.photons);
        ui.add(DragValue::new(&mut settings.photons).range(1..=100_000_000).speed(speed));
    });
    row(ui, "radius", |ui| {
        ui.horizontal(|ui| radius(ui, &mut settings.radius));
    });
    let rules = [
        (RadiusRule::Global, "global"),
        (RadiusRule::Local, "local"),
        (RadiusRule::Fixed, "fixed"),
    ];
    row(ui, "radius rule", |ui| choice(ui, "rule", &mut settings.radius_rule, &rules));
    row(ui, "alpha", |ui| {
        ui.add(DragValue::new(&mut settings.alpha).range(0.01..=1.0).speed(0.005).max_decimals(3));
    });
    let direct = [(Direct::Sampled, "shadow rays"), (Direct::Photons, "photons")];
    row(ui, "direct light", |ui| choice(ui, "direct", &mut settings.direct, &direct));
}

fn device(ui: &mut Ui, wanted: &mut Wanted) {
    let words = ["auto", "gpu", "software", "cpu", "cpu-f64"];
    let now = match wanted {
        Wanted::Named(name) => name.as_str(),
        _ => words.into_iter().find(|word| device::parse(word) == *wanted).unwrap_or(""),
    };
    let mut chosen = None;
    ComboBox::from_id_salt("device").selected_text(now).width(110.0).show_ui(ui, |ui| {
        for word in words {
            if ui.selectable_label(word == now, word).clicked() {
                chosen = Some(device::parse(word));
            }
        }
    });
    *wanted = chosen.unwrap_or_else(|| wanted.clone());
}

fn radius(ui: &mut Ui, radius: &mut Radius) {
    let kinds = ["auto", "pixels", "units"];
    let (mut kind, mut number) = match *radius {
        Radius::Auto => ("auto", 2.0),
        Radius::Pixels(pixels) => ("pixels", pixels),
        Radius::Units(units) => ("units", units),
    };
    if kind != "auto" {
        let speed = 0.01 * number;
        ui.add(DragValue::new(&mut number).range(LENGTHS).speed(speed).max_decimals(6));
    }
    let before = kind;
    let width = if kind == "auto" { 110.0 } else { 60.0 };
    ComboBox::from_id_salt("radius").selected_text(kind).width(width).show_ui(ui, |ui| {
        for word in kinds {
            ui.selectable_value(&mut kind, word, word);
        }
    });
    // a number of pixels is meaningless in units, so a change of kind starts from a usual value
    *radius = match (kind, kind == before) {
        ("pixels", same) => Radius::Pixels(if same { number } else { 2.0 }),
        ("units", same) => Radius::Units(if same { number } else { 0.01 }),
        _ => Radius::Auto,
    };
}

fn camera(ui: &mut Ui, session: &mut Session) {
    let camera = &mut session.now.camera;
    match &mut camera.projection {
        Projection::Perspective { fov_degrees, .. } => angle(ui, fov_degrees, 170.0),
        Projection::Fisheye { fov_degrees, .. } => angle(ui, fov_degrees, 360.0),
        Projection::Orthographic { size, .. } => row(ui, "image size", |ui| {
            let speed = 0.005 * *size;
            ui.add(DragValue::new(size).range(LENGTHS).speed(speed).max_decimals(4));
        }),
        Projection::Panorama => {}
    }
    if camera.has_lens() {
        lens(ui, camera);
    }
    let place = |p: glam::DVec3| format!("{:.3}  {:.3}  {:.3}", p.x, p.y, p.z);
    row(ui, "position", |ui| {
        ui.label(place(camera.position));
    });
    row(ui, "target", |ui| {
        ui.label(place(camera.target));
    });
}

fn angle(ui: &mut Ui, degrees: &mut f64, most: f64) {
    row(ui, "field of view", |ui| {
        ui.add(DragValue::new(degrees).range(1.0..=most).speed(0.1).max_decimals(2).suffix("°"));
    });
}

fn lens(ui: &mut Ui, camera: &mut Camera) {
    row(ui, "aperture", |ui| {
        let speed = 0.002 * camera.focus.max(camera.aperture);
        ui.add(
            DragValue::new(&mut camera.aperture)
                .range(0.0..=1e6)
                .speed(0.1 * speed)
                .max_decimals(6),
        );
    });
    row(ui, "focus", |ui| {
        let speed = 0.005 * camera.focus;
        ui.add(DragValue::new(&mut camera.focus).range(LENGTHS).speed(speed).max_decimals(4));
    });
}

/// The status lines below the image: progress and speed, then error, radius and memory.
pub fn figures(frame: &Frame, passes: u32, paused: bool) -> [String; 2] {
    let per_second = f64::from(frame.passes) / frame.elapsed.as_secs_f64().max(1e-9);
    let made = if frame.quick {
        let halted = if paused { "paused" } else { "the full-size image follows" };
        let Picture { width, height, .. } = frame.picture;
        format!("small image, {width} × {height}, pass {}; {halted}", frame.passes)
    } else {
        let rest = match frame.passes >= passes {
            true => ", done",
            false if paused => ", paused",
            false => "",
        };
        format!("pass {} of {passes}{rest}", frame.passes)
    };
    let error = frame.error.map_or("error available from pass 4".to_owned(), |error| {
        let [stated, noise, bias] =
            [error.stated, error.noise, error.bias].map(|share| 100.0 * share);
        format!("error {stated:.1} % (noise {noise:.1} %, bias {bias:.1} %)")
    });
    let rays = frame.rays_per_second() / 1e6;
    let mebibytes = frame.setup.bytes as f64 / f64::from(1 << 20);
    [
        format!(
            "{made}  ·  {per_second:.1} passes/s, {rays:.1} M rays/s  ·  {}",
            frame.setup.device
        ),
        format!("{error}  ·  radius {:.4}  ·  {mebibytes:.0} MiB", frame.radius),
    ]
}

/// Draws the color scale of a view.
pub fn scale(ui: &mut Ui, scale: &Scale) {
    const STEPS: usize = 48;
    ui.horizontal(|ui| {
        ui.label(number(scale.low));
        let (rect, _) =
            ui.allocate_exact_size(egui::vec2(3.0 * STEPS as f32, 10.0), egui::Sense::hover());
        for step in 0..STEPS {
            let share = (step as f64 + 0.5) / STEPS as f64;
            let value = match scale.logarithmic {
                true => scale.low * (scale.high / scale.low).powf(share),
                false => scale.low + share * (scale.high - scale.low),
            };
            let [r, g, b] = scale.color(value);
            let left = rect.left() + 3.0 * step as f32;
            let cell = egui::Rect::from_min_size(
                egui::pos2(left, rect.top()),
                egui::vec2(3.0, rect.height()),
            );
            ui.painter().rect_filled(cell, 0.0, egui::Color32::from_rgb(r, g, b));
        }
        let steps = if scale.logarithmic { ", logarithmic" } else { "" };
        ui.label(format!("{} {}{steps}", number(scale.high), scale.unit));
    });
}

fn number(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x) {
        format!("{:.4}", x).trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{x:.2e}")
    }
}

/// Shows the table of keys and mouse actions.
pub fn help(ui: &mut Ui) {
    let room = ui.ctx().content_rect().height() - 80.0;
    ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
        Grid::new("help").num_columns(2).spacing([16.0, 1.0]).min_row_height(14.0).show(ui, |ui| {
            for line in TABLE {
                ui.label(RichText::new(line.keys).strong());
                ui.add(
                    egui::Label::new(format!("{}  ", line.what))
                        .wrap_mode(egui::TextWrapMode::Extend),
                );
                ui.end_row();
            }
        });
    });
}
