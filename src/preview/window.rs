//! The preview window: image, overlays and mouse input.

use std::f32::consts::PI;
use std::sync::Arc;
use std::time::Instant;

use eframe::egui::{
    self, Align2, CentralPanel, Color32, ColorImage, Context, FontId, Panel, PointerButton, Pos2,
    Rect, Response, Sense, TextureHandle, TextureOptions, Ui, ViewportBuilder, ViewportCommand,
};
use thiserror::Error;

use super::comparison::Comparison;
use super::frame::Frame;
use super::keys::{Command, pressed};
use super::panels;
use super::session::{Action, Session, Start};
use super::view::{Scale, Shown, View, show};
use crate::film::{Development, FileError};

/// Width of the settings panel, in points.
const PANEL: f32 = 250.0;
/// Limits the conversion of frames for display to one part in about this many of the window's time,
/// so that input stays responsive.
const SHARE: u32 = 4;
/// Distance from the dividing line at which the mouse grips it, in points.
const GRIP: f32 = 8.0;

/// Reason why no window opens.
#[derive(Debug, Error)]
pub enum WindowError {
    /// There is no display.
    #[error("no window can be opened: {0}")]
    NoDisplay(String),
    /// No graphics device can draw the window.
    #[error("no graphics device can draw the window: {0}")]
    NoDevice(String),
    /// The comparison image cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
}

/// Initial comparison.
pub enum Against {
    /// An image file.
    File(std::path::PathBuf),
    /// Another device.
    Device(String),
}

/// Opens a preview window, and returns when it is closed.
pub fn open(start: Start, against: Option<Against>) -> Result<(), WindowError> {
    let comparison = match &against {
        Some(Against::File(file)) => Some(Comparison::file(file)?),
        _ => None,
    };
    let film = start.loaded.scene.film;
    let size = [
        (film.width as f32 + PANEL + 24.0).clamp(820.0, 1600.0),
        (film.height as f32 + 48.0).clamp(600.0, 1000.0),
    ];
    let title = format!("{} - caustica", start.loaded.scene.name);
    let viewport = ViewportBuilder::default()
        .with_title(&title)
        .with_app_id("caustica")
        .with_inner_size(size)
        .with_min_inner_size([480.0, 320.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let create = |creation: &eframe::CreationContext| {
        let context = creation.egui_ctx.clone();
        context.set_theme(egui::Theme::Dark);
        let waking = context.clone();
        let wake = move || waking.request_repaint();
        let mut session = Session::start(start, wake.clone());
        comparison.into_iter().for_each(|comparison| session.hold(comparison));
        if let Some(Against::Device(name)) = &against {
            session.beside_device(name, wake);
        }
        Ok(Box::new(Window::new(session)) as Box<dyn eframe::App>)
    };
    eframe::run_native(&title, options, Box::new(create)).map_err(|error| match error {
        eframe::Error::Wgpu(error) => WindowError::NoDevice(error.to_string()),
        error => WindowError::NoDisplay(error.to_string()),
    })
}

/// Inputs from which a texture was made.
#[derive(Clone, PartialEq)]
struct Source {
    frame: Option<*const Frame>,
    view: View,
    development: Development,
    /// Color scale of the other image.
    scale: Option<Scale>,
}

/// An image on the graphics device.
#[derive(Default)]
struct Painted {
    source: Option<Source>,
    texture: Option<TextureHandle>,
    scale: Option<Scale>,
    /// Keeps the address in `source` from being reused.
    frame: Option<Arc<Frame>>,
    /// Time before which a newer frame alone does not update the texture.
    next: Option<Instant>,
}

impl Painted {
    /// Updates the texture if its inputs have changed.
    fn update(
        &mut self,
        context: &Context,
        name: &str,
        frame: Option<Arc<Frame>>,
        (view, development, scale): (View, Development, Option<Scale>),
        shown: impl FnOnce() -> Option<Shown>,
    ) {
        let source = Source { frame: frame.as_ref().map(Arc::as_ptr), view, development, scale };
        if self.source.as_ref() == Some(&source) {
            return;
        }
        let begun = Instant::now();
        let before = self.source.as_ref();
        let same_view = before.is_some_and(|before| before.view == view);
        let same_look = same_view && before.is_some_and(|before| before.development == development);
        if let Some(next) = self.next.filter(|next| same_look && begun < *next) {
            context.request_repaint_after(next - begun);
            return;
        }
        let smooth = frame.as_ref().is_some_and(|frame| frame.quick);
        (self.source, self.frame) = (Some(source), frame);
        let Some(shown) = shown() else {
            // while a layer is pending, the last image of the same view stays
            if !same_view {
                (self.texture, self.scale) = (None, None);
            }
            return;
        };
        let size = [shown.width as usize, shown.height as usize];
        let image = ColorImage::from_rgb(size, shown.rgb.as_flattened());
        let magnification =
            if smooth { egui::TextureFilter::Linear } else { egui::TextureFilter::Nearest };
        let options = TextureOptions { magnification, ..TextureOptions::LINEAR };
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(context.load_texture(name, image, options)),
        }
        self.scale = shown.scale;
        self.next = Some(Instant::now() + SHARE * begun.elapsed());
    }
}

struct Window {
    session: Session,
    picture: Painted,
    other: Painted,
    help: bool,
    panel: bool,
    /// True if the mouse drags the dividing line.
    gripped: bool,
}

impl Window {
    fn new(session: Session) -> Self {
        let (picture, other) = Default::default();
        Self { session, picture, other, help: false, panel: true, gripped: false }
    }

    fn carry_out(&mut self, context: &Context, command: Command) {
        match command {
            Command::Act(action) => self.session.act(action),
            Command::Help => self.help = !self.help,
            Command::Panel => self.panel = !self.panel,
            Command::Close => context.send_viewport_cmd(ViewportCommand::Close),
        }
    }

    fn figures(&self, ui: &mut Ui) {
        ui.add_space(2.0);
        let session = &self.session;
        let figures = match session.frame() {
            Some(frame) => panels::figures(&frame, session.now.settings.passes, session.paused),
            None => ["rendering the first image".to_owned(), String::new()],
        };
        for line in figures {
            ui.add(egui::Label::new(line).truncate());
        }
        let notice = if session.notice.is_empty() { "F1: help" } else { &session.notice };
        ui.add(egui::Label::new(egui::RichText::new(notice).weak()).truncate());
        ui.add_space(2.0);
    }

    /// Shows errors over the image, which stays.
    fn trouble(&self, context: &Context) {
        let trouble = self.session.trouble.clone().or(self.session.failure());
        let Some(text) = trouble else {
            return;
        };
        let title = match self.session.trouble {
            Some(_) => "Error in the scene; the last image stays",
            None => "Rendering has stopped",
        };
        egui::Window::new(title)
            .id(egui::Id::unique("trouble"))
            .collapsible(true)
            .resizable(false)
            .default_width(460.0)
            .anchor(Align2::LEFT_TOP, [12.0, 12.0])
            .show(context, |ui| {
                egui::ScrollArea::vertical().max_height(240.0).show(ui, |ui| {
                    ui.colored_label(Color32::from_rgb(255, 160, 120), text);
                });
            });
    }

    fn picture(&mut self, ui: &mut Ui) {
        let film = self.session.now.film;
        let room = ui.available_rect_before_wrap();
        let whole = egui::vec2(film.width as f32, film.height as f32);
        let factor = (room.width() / whole.x).min(room.height() / whole.y);
        let rect = Rect::from_center_size(room.center(), whole * factor);
        let response = ui.interact(rect, ui.scope_id().with("picture"), Sense::click_and_drag());
        self.paint(ui, rect);
        self.hand(ui, rect, &response);
    }

    fn paint(&mut self, ui: &Ui, rect: Rect) {
        let session = &self.session;
        let (view, development) = (session.view, session.development());
        let context = ui.ctx();
        let frame = session.frame();
        self.picture.update(context, "picture", frame.clone(), (view, development, None), || {
            show(&*frame?, view, &development, None)
        });
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        let painter = ui.painter_at(rect);
        match &self.picture.texture {
            Some(texture) => {
                painter.image(texture.id(), rect, all, Color32::WHITE);
            }
            None => {
                let text = format!("rendering the {} view", view.word());
                painter.text(
                    rect.center(),
                    Align2::CENTER_CENTER,
                    text,
                    FontId::proportional(16.0),
                    Color32::GRAY,
                );
            }
        }
        let (Some(split), Some(comparison)) = (session.split, &session.comparison) else {
            return;
        };
        let scale = self.picture.scale;
        self.other.update(context, "other", comparison.frame(), (view, development, scale), || {
            comparison.show(view, &development, scale)
        });
        let line = rect.left() + split * rect.width();
        let right = Rect::from_min_max(Pos2::new(line, rect.top()), rect.max);
        painter.rect_filled(right, 0.0, Color32::from_gray(20));
        if let Some(texture) = &self.other.texture {
            let part = Rect::from_min_max(Pos2::new(split, 0.0), Pos2::new(1.0, 1.0));
            painter.image(texture.id(), right, part, Color32::WHITE);
        }
        painter.vline(line, rect.y_range(), egui::Stroke::new(1.5, Color32::WHITE));
        let label = |at: Pos2, anchor: Align2, text: &str| {
            let galley =
                painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), Color32::WHITE);
            let place = anchor.anchor_size(at, galley.size());
            painter.rect_filled(place.expand(3.0), 2.0, Color32::from_black_alpha(160));
            painter.galley(place.min, galley, Color32::WHITE);
        };
        label(rect.left_bottom() + egui::vec2(10.0, -10.0), Align2::LEFT_BOTTOM, "this");
        label(
            rect.right_bottom() + egui::vec2(-10.0, -10.0),
            Align2::RIGHT_BOTTOM,
            &comparison.name,
        );
    }

    fn hand(&mut self, ui: &Ui, rect: Rect, response: &Response) {
        let shift = ui.input(|input| input.modifiers.shift);
        let line = self.session.split.map(|split| rect.left() + split * rect.width());
        let near =
            |at: Option<Pos2>| line.zip(at).is_some_and(|(line, at)| (line - at.x).abs() < GRIP);
        if self.gripped || near(response.hover_pos()) {
            ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
        }
        if response.drag_started() {
            self.gripped = near(ui.input(|input| input.pointer.press_origin()));
        } else if !response.dragged() {
            self.gripped = false;
        }
        let moved = response.drag_delta() / rect.height();
        let across = response.dragged_by(PointerButton::Secondary)
            || response.dragged_by(PointerButton::Middle)
            || shift && response.dragged_by(PointerButton::Primary);
        if self.gripped {
            let at = response.interact_pointer_pos().map(|at| (at.x - rect.left()) / rect.width());
            self.session.split = at.map(|at| at.clamp(0.0, 1.0)).or(self.session.split);
        } else if moved != egui::Vec2::ZERO && across {
            self.session.act(Action::Pan(moved.x.into(), moved.y.into()));
        } else if moved != egui::Vec2::ZERO && response.dragged_by(PointerButton::Primary) {
            // the side of the scene in front of the target follows the mouse
            self.session.act(Action::Orbit((-PI * moved.x).into(), (PI * moved.y).into()));
        }
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) {
            let place = (at - rect.min) / rect.size();
            self.session.act(Action::Focus(place.x.into(), place.y.into()));
        }
        let scroll = ui.input(|input| input.smooth_scroll_delta().y);
        if scroll != 0.0 && response.hovered() {
            self.session.act(Action::Dolly((-0.002 * f64::from(scroll)).exp()));
        }
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        let mut commands =
            if context.egui_wants_keyboard_input() { Vec::new() } else { context.input(pressed) };
        if self.panel {
            let panel = Panel::right("settings").exact_size(PANEL).resizable(false);
            commands.extend(panel.show(ui, |ui| panels::settings(ui, &mut self.session)).inner);
        }
        Panel::bottom("figures").show(ui, |ui| {
            if let Some(scale) = &self.picture.scale {
                panels::scale(ui, scale);
            }
            self.figures(ui);
        });
        CentralPanel::no_frame().show(ui, |ui| self.picture(ui));
        self.trouble(&context);
        let mut help = self.help;
        egui::Window::new("Keys and mouse")
            .open(&mut help)
            .resizable(false)
            .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
            .show(&context, panels::help);
        self.help = help;
        for command in commands {
            self.carry_out(&context, command);
        }
        self.session.tick();
    }
}
