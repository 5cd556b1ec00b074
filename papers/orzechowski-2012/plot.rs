//! A small plotting layer over plotters' canvas: sheets of panels with linear or logarithmic
//! axes, one shared legend below, and the same drawing as SVG and PNG. The font comes from a
//! crate, so that figures look alike on a machine without fonts.

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontTransform;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use brush::{Brush, write_png};
use canvas::{clip, dashes, ticks};

#[path = "brush.rs"]
mod brush;
#[path = "canvas.rs"]
mod canvas;

/// Colours that stay apart in print and for colour-blind readers (Okabe and Ito).
pub mod colour {
    use plotters::style::RGBColor;

    /// References.
    pub const BLACK: RGBColor = RGBColor(0, 0, 0);
    /// First series.
    pub const BLUE: RGBColor = RGBColor(0, 114, 178);
    /// Second series.
    pub const ORANGE: RGBColor = RGBColor(213, 94, 0);
    /// Third series.
    pub const GREEN: RGBColor = RGBColor(0, 158, 115);
    /// Fourth series.
    pub const PINK: RGBColor = RGBColor(204, 121, 167);
    /// Fifth series.
    pub const SKY: RGBColor = RGBColor(86, 180, 233);
    /// Sixth series.
    pub const AMBER: RGBColor = RGBColor(230, 159, 0);
    /// Seventh series.
    pub const BROWN: RGBColor = RGBColor(140, 90, 50);
    /// Guides.
    pub const GREY: RGBColor = RGBColor(130, 130, 130);
}

/// How an axis maps values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By decimal logarithm.
    Log,
}

/// One axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// First and last value.
    pub range: [f64; 2],
    /// Mapping.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: &str, from: f64, to: f64) -> Self {
        Self {
            label: label.into(),
            range: [from, to],
            scale: Scale::Linear,
        }
    }

    /// A logarithmic axis.
    pub fn log(label: &str, from: f64, to: f64) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::linear(label, from, to)
        }
    }

    fn share(&self, value: f64) -> f64 {
        let f = |x: f64| match self.scale {
            Scale::Linear => x,
            Scale::Log => x.max(1e-300).log10(),
        };
        let [from, to] = self.range.map(f);
        (f(value) - from) / (to - from)
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A solid line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A line with a dot at every point.
    Marked,
    /// Crosses only.
    Crosses,
    /// The polygon, filled and outlined.
    Filled,
}

/// One series of points.
#[derive(Debug, Clone)]
pub struct Series {
    /// Entry of the legend; none if empty.
    pub name: String,
    /// Colour.
    pub colour: RGBColor,
    /// Drawing.
    pub stroke: Stroke,
    /// Points in the units of the axes.
    pub points: Vec<[f64; 2]>,
}

impl Series {
    /// A series with a legend entry.
    pub fn new(name: &str, colour: RGBColor, stroke: Stroke, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.into(),
            colour,
            stroke,
            points,
        }
    }
}

/// One coordinate system.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Title above it.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, in this order.
    pub series: Vec<Series>,
    /// Words at a point, in the units of the axes.
    pub notes: Vec<([f64; 2], String)>,
}

/// A page of panels with one legend.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Size in pixels; figures are twice as large as they are shown.
    pub size: [u32; 2],
    /// Panels side by side.
    pub columns: usize,
    /// Columns of the legend.
    pub legend: usize,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
}

type Drawn = Result<(), Box<dyn Error>>;
const FONT: &str = "sans-serif";
const TEXT: i32 = 26;
const ROW: i32 = 38;

/// Makes the font known; call once.
///
/// # Errors
/// When the font cannot be read.
pub fn prepare() -> Drawn {
    plotters::style::register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
        .map_err(|_| "the bundled font cannot be read".into())
}

impl Sheet {
    /// Panels side by side, with this many columns of the legend.
    pub fn row(size: [u32; 2], legend: usize, panels: Vec<Panel>) -> Self {
        Self {
            size,
            columns: panels.len(),
            legend,
            panels,
        }
    }

    /// Writes `name.svg` and `name.png` into a directory.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn save(&self, directory: &Path, name: &str) -> Drawn {
        let [width, height] = self.size;
        let path = directory.join(name);
        let svg = path.with_extension("svg");
        self.draw(SVGBackend::new(&svg, (width, height)).into_drawing_area())?;
        let mut pixels = vec![255; 3 * (width * height) as usize];
        self.draw(Brush::new(&mut pixels, (width, height)).into_drawing_area())?;
        write_png(&path.with_extension("png"), &pixels, (width, height))
    }

    fn entries(&self) -> Vec<&Series> {
        let mut entries: Vec<&Series> = Vec::new();
        for series in self.panels.iter().flat_map(|p| &p.series) {
            if !series.name.is_empty() && entries.iter().all(|e| e.name != series.name) {
                entries.push(series);
            }
        }
        entries
    }

    fn draw<DB>(&self, area: DrawingArea<DB, Shift>) -> Drawn
    where
        DB: DrawingBackend,
        DB::ErrorType: 'static,
    {
        area.fill(&WHITE)?;
        let entries = self.entries();
        let rows = entries.len().div_ceil(self.legend) as i32;
        let top = self.size[1] as i32 - rows * ROW - 16;
        let (upper, _) = area.split_vertically(top);
        let lines = self.panels.len().div_ceil(self.columns);
        let cells = upper.split_evenly((lines, self.columns));
        for (panel, cell) in self.panels.iter().zip(&cells) {
            panel.draw(cell)?;
        }
        let wide = (self.size[0] as i32 - 60) / self.legend as i32;
        for (k, series) in entries.into_iter().enumerate() {
            let x = 50 + (k % self.legend) as i32 * wide;
            let y = top + ROW / 2 + (k / self.legend) as i32 * ROW;
            let sample = match series.stroke {
                Stroke::Filled => vec![[0.0, -9.0], [60.0, -9.0], [60.0, 9.0], [0.0, 9.0]],
                Stroke::Crosses => vec![[30.0, 0.0]],
                _ => vec![[0.0, 0.0], [60.0, 0.0]],
            };
            let at = |p: &[f64; 2]| [p[0] + f64::from(x), p[1] + f64::from(y)];
            stroke(&area, series, &sample.iter().map(at).collect::<Vec<_>>())?;
            dots(&area, series, &[at(&[30.0, 0.0])])?;
            let style = text(TEXT, Pos::new(HPos::Left, VPos::Center));
            area.draw_text(&series.name, &style, (x + 74, y))?;
        }
        area.present()?;
        Ok(())
    }
}

fn text(size: i32, position: Pos) -> TextStyle<'static> {
    TextStyle::from((FONT, size).into_font())
        .color(&BLACK)
        .pos(position)
}

/// Draws a series through points in pixels.
fn stroke<DB>(area: &DrawingArea<DB, Shift>, series: &Series, pixels: &[[f64; 2]]) -> Drawn
where
    DB: DrawingBackend,
    DB::ErrorType: 'static,
{
    let round = |p: &[f64; 2]| (p[0].round() as i32, p[1].round() as i32);
    let mut points: Vec<(i32, i32)> = pixels.iter().map(round).collect();
    points.dedup();
    let line = series.colour.stroke_width(4);
    match series.stroke {
        Stroke::Solid | Stroke::Marked => area.draw(&PathElement::new(points, line))?,
        Stroke::Dashed => {
            for dash in dashes(pixels, 16.0, 11.0) {
                let dash: Vec<_> = dash.iter().map(round).collect();
                area.draw(&PathElement::new(dash, line))?;
            }
        }
        Stroke::Crosses => {
            for (x, y) in points {
                for sign in [-1, 1] {
                    let ends = vec![(x - 11, y - 11 * sign), (x + 11, y + 11 * sign)];
                    area.draw(&PathElement::new(ends, line))?;
                }
            }
        }
        Stroke::Filled => {
            area.draw(&Polygon::new(points.clone(), series.colour.mix(0.25)))?;
            points.extend(points.first().copied());
            area.draw(&PathElement::new(points, series.colour.stroke_width(2)))?;
        }
    }
    Ok(())
}

/// Draws the dots of a marked series at points in pixels.
fn dots<DB>(area: &DrawingArea<DB, Shift>, series: &Series, pixels: &[[f64; 2]]) -> Drawn
where
    DB: DrawingBackend,
    DB::ErrorType: 'static,
{
    if series.stroke == Stroke::Marked {
        for [x, y] in pixels {
            let centre = (x.round() as i32, y.round() as i32);
            area.draw(&Circle::new(centre, 7, series.colour.filled()))?;
        }
    }
    Ok(())
}

impl Panel {
    /// A panel without notes.
    pub fn new(title: &str, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            series,
            notes: Vec::new(),
        }
    }

    fn draw<DB>(&self, area: &DrawingArea<DB, Shift>) -> Drawn
    where
        DB: DrawingBackend,
        DB::ErrorType: 'static,
    {
        let (width, height) = area.dim_in_pixel();
        let (left, right) = (130.0, f64::from(width) - 34.0);
        let (top, bottom) = (62.0, f64::from(height) - 92.0);
        let px = |x: f64| left + self.x.share(x) * (right - left);
        let py = |y: f64| bottom - self.y.share(y) * (bottom - top);
        let int = |x: f64| x.round() as i32;
        let middle = int(0.5 * (left + right));
        let title = text(TEXT + 3, Pos::new(HPos::Center, VPos::Center));
        area.draw_text(&self.title, &title, (middle, int(top) - 32))?;
        let grid = RGBColor(222, 222, 222);
        let below = text(TEXT - 2, Pos::new(HPos::Center, VPos::Top));
        for (value, label) in ticks(&self.x) {
            let x = int(px(value));
            let ends = vec![(x, int(top)), (x, int(bottom))];
            area.draw(&PathElement::new(ends, grid.stroke_width(2)))?;
            area.draw_text(&label, &below, (x, int(bottom) + 10))?;
        }
        let beside = text(TEXT - 2, Pos::new(HPos::Right, VPos::Center));
        for (value, label) in ticks(&self.y) {
            let y = int(py(value));
            let ends = vec![(int(left), y), (int(right), y)];
            area.draw(&PathElement::new(ends, grid.stroke_width(2)))?;
            area.draw_text(&label, &beside, (int(left) - 10, y))?;
        }
        let under = text(TEXT, Pos::new(HPos::Center, VPos::Center));
        area.draw_text(&self.x.label, &under, (middle, int(bottom) + 66))?;
        let turned = (FONT, TEXT).into_font().transform(FontTransform::Rotate270);
        let turned = TextStyle::from(turned).pos(Pos::new(HPos::Center, VPos::Center));
        area.draw_text(&self.y.label, &turned, (26, int(0.5 * (top + bottom))))?;
        for series in &self.series {
            let pixels: Vec<_> = series.points.iter().map(|p| [px(p[0]), py(p[1])]).collect();
            if series.stroke == Stroke::Filled {
                stroke(area, series, &pixels)?;
                continue;
            }
            for piece in clip(&pixels, [left, top, right, bottom]) {
                stroke(area, series, &piece)?;
            }
            let inside =
                |[x, y]: &&[f64; 2]| (left..=right).contains(x) && (top..=bottom).contains(y);
            let inside: Vec<_> = pixels.iter().filter(inside).copied().collect();
            dots(area, series, &inside)?;
        }
        for ([x, y], note) in &self.notes {
            let style = text(TEXT - 2, Pos::new(HPos::Left, VPos::Center));
            area.draw_text(note, &style, (int(px(*x)), int(py(*y))))?;
        }
        let corners = [(int(left), int(top)), (int(right), int(bottom))];
        area.draw(&Rectangle::new(corners, BLACK.stroke_width(2)))?;
        Ok(())
    }
}
