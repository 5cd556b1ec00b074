//! A canvas for PNG files that draws smooth lines: plotters' own bitmap backend leaves gaps in
//! thick lines with sharp turns. Everything else is handed through.

use std::collections::HashMap;
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use plotters::backend::BitMapBackend;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, DrawingBackend, DrawingErrorKind,
};

/// A bitmap whose lines are strokes with round ends and soft edges.
pub struct Brush<'a> {
    bitmap: BitMapBackend<'a>,
}

impl<'a> Brush<'a> {
    /// A brush on a buffer of RGB bytes.
    pub fn new(pixels: &'a mut [u8], size: (u32, u32)) -> Self {
        Self {
            bitmap: BitMapBackend::with_buffer(pixels, size),
        }
    }

    fn blend(
        &mut self,
        cover: HashMap<BackendCoord, f64>,
        colour: BackendColor,
    ) -> Result<(), DrawingErrorKind<<Self as DrawingBackend>::ErrorType>> {
        for (pixel, share) in cover {
            self.bitmap.draw_pixel(pixel, colour.mix(share))?;
        }
        Ok(())
    }
}

/// Share of each pixel that a stroke between two points covers, the largest of all strokes.
fn cover(
    cover: &mut HashMap<BackendCoord, f64>,
    from: BackendCoord,
    to: BackendCoord,
    radius: f64,
) {
    let [ax, ay, bx, by] = [from.0, from.1, to.0, to.1].map(f64::from);
    let (dx, dy) = (bx - ax, by - ay);
    let square = (dx * dx + dy * dy).max(1e-12);
    let reach = radius + 1.0;
    let range = |a: f64, b: f64| (a.min(b) - reach) as i32..=(a.max(b) + reach) as i32;
    for y in range(ay, by) {
        for x in range(ax, bx) {
            let (px, py) = (f64::from(x) - ax, f64::from(y) - ay);
            let s = ((px * dx + py * dy) / square).clamp(0.0, 1.0);
            let distance = (px - s * dx).hypot(py - s * dy);
            let share = (radius + 0.5 - distance).clamp(0.0, 1.0);
            if share > 0.0 {
                let most = cover.entry((x, y)).or_insert(0.0);
                *most = most.max(share);
            }
        }
    }
}

impl DrawingBackend for Brush<'_> {
    type ErrorType = <BitMapBackend<'static> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.bitmap.get_size()
    }

    fn ensure_prepared(&mut self) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.bitmap.ensure_prepared()
    }

    fn present(&mut self) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.bitmap.present()
    }

    fn draw_pixel(
        &mut self,
        point: BackendCoord,
        colour: BackendColor,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        self.bitmap.draw_pixel(point, colour)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        let points: Vec<_> = path.into_iter().collect();
        let radius = 0.5 * f64::from(style.stroke_width());
        let mut covered = HashMap::new();
        for pair in points.windows(2) {
            cover(&mut covered, pair[0], pair[1], radius);
        }
        self.blend(covered, style.color())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        _fill: bool,
    ) -> Result<(), DrawingErrorKind<Self::ErrorType>> {
        let mut covered = HashMap::new();
        cover(&mut covered, centre, centre, f64::from(radius));
        self.blend(covered, style.color())
    }
}

/// Writes RGB bytes as a PNG file, as small as the format allows.
///
/// # Errors
/// When the file cannot be written.
pub fn write_png(path: &Path, pixels: &[u8], size: (u32, u32)) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(())
}
