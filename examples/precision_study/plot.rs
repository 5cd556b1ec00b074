//! Panels of curves on logarithmic axes, as SVG and PNG.

use plotters::prelude::*;
use std::path::Path;

pub type Done = Result<(), Box<dyn std::error::Error>>;
/// Title of a panel; names and points of its curves.
pub type Panel<'a> = (&'a str, [(&'a str, Vec<(f64, f64)>); 4]);

const SIZE: (u32, u32) = (1500, 560);
const FONT: &str = "sans-serif";
const COLOURS: [RGBColor; 4] = [
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
];

fn paint<B: DrawingBackend<ErrorType: 'static>>(backend: B, sheet: &[Panel<'_>]) -> Done {
    let area = backend.into_drawing_area();
    area.fill(&WHITE)?;
    for (panel, (title, curves)) in area.split_evenly((1, sheet.len())).iter().zip(sheet) {
        let mut builder = ChartBuilder::on(panel);
        builder
            .margin(16)
            .x_label_area_size(50)
            .y_label_area_size(80)
            .caption(title, (FONT, 22));
        let (x, y) = ((0.7e-5..0.15).log_scale(), (1e-14..1e10).log_scale());
        let mut chart = builder.build_cartesian_2d(x, y)?;
        let power = |x: &f64| format!("{x:.0e}");
        let mut mesh = chart.configure_mesh();
        mesh.x_desc("R/L")
            .y_desc("error of the force over P")
            .label_style((FONT, 16));
        mesh.x_label_formatter(&power)
            .y_label_formatter(&power)
            .draw()?;
        for ((name, points), colour) in curves.iter().zip(COLOURS) {
            let dots = points.iter().map(|&p| Circle::new(p, 4, colour.filled()));
            let line = PathElement::new(points.clone(), colour.stroke_width(2));
            chart.draw_series([line])?;
            let dots = chart.draw_series(dots)?.label(*name);
            dots.legend(move |(x, y)| Circle::new((x + 9, y), 5, colour.filled()));
        }
        let mut legend = chart.configure_series_labels();
        legend
            .position(SeriesLabelPosition::UpperRight)
            .label_font((FONT, 16));
        legend.background_style(WHITE).border_style(BLACK).draw()?;
    }
    Ok(area.present()?)
}

/// Draws the panels side by side into `error.svg` and `error.png` of a folder.
pub fn draw(folder: &str, sheet: &[Panel<'_>]) -> Done {
    let folder = Path::new(folder);
    std::fs::create_dir_all(folder)?;
    plotters::style::register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
        .map_err(|_| "the font cannot be read")?;
    paint(SVGBackend::new(&folder.join("error.svg"), SIZE), sheet)?;
    let mut pixels = vec![0; 3 * (SIZE.0 * SIZE.1) as usize];
    paint(BitMapBackend::with_buffer(&mut pixels, SIZE), sheet)?;
    let file = std::fs::File::create(folder.join("error.png"))?;
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), SIZE.0, SIZE.1);
    encoder.set_color(png::ColorType::Rgb);
    Ok(encoder.write_header()?.write_image_data(&pixels)?)
}
