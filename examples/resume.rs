//! A run that lasts: Ctrl-C stops it after the step under way, `--resume` goes on to the last bit as if
//! nothing had happened: `cargo run --release --features serde --example resume [-- --resume]`.

use std::fs::{OpenOptions, read_to_string, rename, write};
use std::io::Write;
use std::ops::ControlFlow::{Break, Continue};
use std::sync::atomic::{AtomicBool, Ordering};

use ancf::prelude::*;

static STOP: AtomicBool = AtomicBool::new(false);
const KEPT: &str = "target/resume.json";

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    let mut scene = Scene::<f64, 3>::new();
    let (disk, solid) = (Disk::new(0.01)?, Continuum::full(rubber));
    let rod = Beam::new(FullyParameterised, disk, solid);
    let rod = scene.add(rod.straight([0.0; 3], [1.0, 0.0, 0.0], 6).density(7200.0))?;
    scene.pin(rod.start())?;
    scene.gravity([0.0, -9.81, 0.0])?;
    let system = scene.assemble()?;

    let scheme = EnergyMomentum::dissipating(1e-3);
    let (step, halvings) = (1e-3, 10);
    let stepping = Stepping::Halved { step, halvings };
    let (mut run, rows) = match std::env::args().any(|arg| arg == "--resume") {
        true => {
            let (kept, rows) = serde_json::from_str(&read_to_string(KEPT)?)?;
            (Integration::resume(&system, &kept, &scheme)?, rows)
        }
        false => (Integration::start(&system, system.rest(), &scheme)?, 0),
    };
    // Rows behind the last checkpoint are cut off: they will be written again.
    let mut csv = OpenOptions::new();
    let mut csv = csv.append(true).create(true).open("target/resume.csv")?;
    csv.set_len(rows)?;
    ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed))?;
    let bar = indicatif::ProgressBar::new(1000);
    let mut text = String::new();
    loop {
        let ending = run.until(60.0, stepping, |step| {
            let [x, y, z] = system.position(step.after, rod.end())?;
            text += &format!("{},{x},{y},{z}\n", step.after.time);
            bar.set_position((1000.0 * step.share()) as u64);
            let due = STOP.load(Ordering::Relaxed) || step.report.steps % 1000 == 0;
            Ok(if due { Break(()) } else { Continue(()) })
        });
        // Rows first, then the checkpoint that counts them, whole under its name or not at all.
        csv.write_all(std::mem::take(&mut text).as_bytes())?;
        csv.sync_all()?;
        let kept = (run.checkpoint()?, csv.metadata()?.len());
        write("target/resume.new", serde_json::to_string(&kept)?)?;
        rename("target/resume.new", KEPT)?;
        if ending? == Ending::End || STOP.load(Ordering::Relaxed) {
            println!("{} s: {:?}", run.state().time, run.report());
            return Ok(());
        }
    }
}
