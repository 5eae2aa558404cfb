//! prototype
use caustica::device;
use caustica::scene;
use std::io::Write;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    // estimate SCENE WxH METHOD RULE DIRECT RADIUS PHOTONS SEED OUT PASS...
    let a: Vec<String> = std::env::args().skip(1).collect();
    let mut loaded = scene::load(a[0].as_ref())?;
    let (w, h) = a[1].split_once('x').unwrap();
    (loaded.scene.film.width, loaded.scene.film.height) = (w.parse()?, h.parse()?);
    let s = &mut loaded.settings;
    s.method = match a[2].as_str() { "ppm" => caustica::settings::Method::Ppm, "path" => caustica::settings::Method::Path, _ => caustica::settings::Method::Sppm };
    s.radius_rule = match a[3].as_str() { "local" => caustica::settings::RadiusRule::Local, "fixed" => caustica::settings::RadiusRule::Fixed, _ => caustica::settings::RadiusRule::Global };
    s.direct = match a[4].as_str() { "photons" => caustica::settings::Direct::Photons, _ => caustica::settings::Direct::Sampled };
    if a[5] != "-" { s.radius = caustica::settings::Radius::Pixels(a[5].parse()?); }
    if a[6] != "-" { s.photons = a[6].parse()?; }
    let (first, last) = a[7].split_once('-').unwrap_or((&a[7], &a[7]));
    let stops: Vec<u32> = a[9..].iter().map(|x| x.parse().unwrap()).collect();
    for seed in first.parse::<u64>()?..=last.parse()? {
        let mut settings = loaded.settings.clone();
        settings.seed = seed;
        let mut engine = device::open(&device::Wanted::Cpu, &loaded.scene, &settings)?.engine;
        let mut done = 0;
        for &stop in &stops {
            while done < stop { engine.pass()?; done += 1; }
            let errors = engine.errors()?;
            let mut out = std::io::BufWriter::new(std::fs::File::create(format!("{}.{seed}.{stop}.bin", a[8]))?);
            for p in &errors.pixels {
                for v in [p.luminance, p.variance, p.swing, p.ring, p.ring_swing, p.halves, p.halves_swing] { out.write_all(&v.to_le_bytes())?; }
            }
            let r = errors.relative();
            println!("{seed} {stop} noise {:.4} bias {:.4} stated {:.4}", r.noise, r.bias, r.stated);
        }
    }
    Ok(())
}
