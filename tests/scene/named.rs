//! The named metals reproduce the measured spectra, and the named glasses their catalogs.

#[allow(dead_code)] // the derivation has functions for the example alone
#[path = "../../examples/named_metals/mod.rs"]
mod named_metals;

use caustica::low_level::scene::named::glasses::{D_LINE_NM, GLASSES, glass, glass_names};
use caustica::low_level::scene::named::metals::{METALS, Metal, metal, metal_names};
use named_metals::fit::{conductor, fit};
use named_metals::observer::{channel_weights, wavelengths};
use named_metals::spectra::{SPECTRA, Spectrum};

type Complex = (f64, f64);

fn mul((a, b): Complex, (c, d): Complex) -> Complex {
    (a * c - b * d, a * d + b * c)
}

fn div(a: Complex, (c, d): Complex) -> Complex {
    let modulus = c * c + d * d;
    mul(a, (c / modulus, -d / modulus))
}

/// Square root with a positive real part.
fn root((a, b): Complex) -> Complex {
    let modulus = a.hypot(b);
    let re = (0.5 * (modulus + a)).sqrt();
    (re, (0.5 * (modulus - a)).sqrt().copysign(b))
}

/// Reflectance of a conductor for unpolarized light, from the amplitudes of Fresnel with Snell's
/// law in complex numbers (Born and Wolf, Principles of Optics, 7th edition, sections 1.5.2 and
/// 14.4.1).
fn reference(cos: f64, eta: f64, k: f64) -> f64 {
    let index = (eta, k);
    let sin = div(((1.0 - cos * cos).sqrt(), 0.0), index);
    let (re, im) = mul(sin, sin);
    let cos_t = root((1.0 - re, -im));
    let amplitude = |a: Complex, b: Complex| div((a.0 - b.0, a.1 - b.1), (a.0 + b.0, a.1 + b.1));
    let s = amplitude((cos, 0.0), mul(index, cos_t));
    let p = amplitude(mul(index, (cos, 0.0)), cos_t);
    0.5 * (s.0 * s.0 + s.1 * s.1 + p.0 * p.0 + p.1 * p.1)
}

/// The analytic color matching functions of Wyman, Sloan and Shirley (Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions, JCGT 2(2), 2013, equation 4).
fn wyman(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, mean: f64, below: f64, above: f64| {
        let t = (nm - mean) * if nm < mean { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(0.362, 442.0, 0.0624, 0.0374)
            + lobe(1.056, 599.8, 0.0264, 0.0323)
            + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    ]
}

/// Wien's law at the correlated color temperature of D65: the spectrum of D65 to about 10 % from
/// 440 to 750 nm, and to 35 % from 400 nm.
fn near_d65(nm: f64) -> f64 {
    nm.powi(-5) * (-1.438_8e7 / (nm * 6504.0)).exp()
}

/// Color of a metal by reference functions alone, limited as in `docs/metals.md`.
fn reference_color(spectrum: &Spectrum, cos: f64) -> [f64; 3] {
    let rgb = [
        [3.2406, -1.5372, -0.4986], // IEC 61966-2-1
        [-0.9689, 1.8758, 0.0415],
        [0.0557, -0.2040, 1.0570],
    ];
    let (mut sum, mut white, mut greatest) = ([0.0; 3], [0.0; 3], 0.0_f64);
    for nm in (380..=780).map(f64::from) {
        let (n, k) = spectrum.at(nm);
        let r = reference(cos, n, k);
        greatest = greatest.max(r);
        for (c, [x, y, z]) in rgb.into_iter().enumerate() {
            let [x_bar, y_bar, z_bar] = wyman(nm);
            let weight = near_d65(nm) * (x * x_bar + y * y_bar + z * z_bar);
            sum[c] += weight * r;
            white[c] += weight;
        }
    }
    std::array::from_fn(|c| (sum[c] / white[c]).clamp(0.0, greatest))
}

fn each(mut check: impl FnMut(&'static Spectrum, &'static Metal)) {
    for spectrum in SPECTRA {
        check(spectrum, metal(spectrum.name).expect(spectrum.name));
    }
}

#[test]
fn spectra_are_well_formed() {
    assert!(METALS.iter().map(|metal| metal.name).eq(SPECTRA.iter().map(|s| s.name)));
    for Spectrum { name, nm, n, k, .. } in SPECTRA {
        assert!(nm.len() == n.len() && nm.len() == k.len(), "{name}");
        assert!(nm.windows(2).all(|pair| pair[0] < pair[1]), "{name}");
        assert!(nm[0] <= 380.0 && nm[nm.len() - 1] >= 780.0, "{name}");
        assert!(n.iter().chain(*k).all(|&value| value > 0.0 && value < 10.0), "{name}");
    }
    let silver = &SPECTRA[SPECTRA.iter().position(|s| s.name == "silver").unwrap()];
    assert_eq!(silver.at(silver.nm[3]), (silver.n[3], silver.k[3]));
    assert_eq!(silver.at(100.0), (silver.n[0], silver.k[0]));
    let middle = silver.at(0.5 * (silver.nm[3] + silver.nm[4])).0;
    assert!((middle - 0.5 * (silver.n[3] + silver.n[4])).abs() < 1e-12);
}

/// The weights of a channel sum to 1. The luminance that they form is that of the analytic observer
/// under D65, to the accuracy of the reference functions; it would not be if D65 were not the white
/// of Rec. 709, because each channel is scaled on its own.
#[test]
fn weights_are_those_of_rec_709() {
    let [red, green, blue] = channel_weights();
    for weights in [red, green, blue] {
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
    let luminance = |i: usize| 0.2126 * red[i] + 0.7152 * green[i] + 0.0722 * blue[i];
    let expected = wavelengths().map(|nm| near_d65(nm) * wyman(nm)[1]);
    let (sum, greatest) =
        (expected.iter().sum::<f64>(), expected.iter().fold(0.0_f64, |a, &b| a.max(b)));
    for (i, expected) in expected.iter().enumerate() {
        assert!((luminance(i) - expected / sum).abs() < 0.05 * greatest / sum, "{i}");
    }
}

/// The Fresnel equations of the fit are those of the reference, and those of glass without
/// absorption.
#[test]
fn fresnel_is_exact() {
    for (eta, k) in [(0.05, 3.5), (0.2, 1.0), (1.5, 1e-9), (3.0, 3.3), (1.2, 7.0)] {
        for i in 0..=100 {
            let cos = f64::from(i) / 100.0;
            let (found, expected) = (conductor(cos, eta, k), reference(cos, eta, k));
            assert!((found - expected).abs() < 1e-9, "{eta} + {k}i at {cos}: {found}, {expected}");
        }
    }
    assert!((conductor(1.0, 1.5, 0.0) - 0.04).abs() < 1e-12);
    let brewster = (1.0_f64 / (1.0 + 1.5 * 1.5)).sqrt();
    let s = (2.25 - 1.0_f64) / (2.25 + 1.0);
    assert!((conductor(brewster, 1.5, 0.0) - 0.5 * s * s).abs() < 1e-12);
}

#[test]
fn the_table_is_what_the_derivation_gives() {
    each(|spectrum, metal| {
        let fit = fit(spectrum);
        for c in 0..3 {
            let (eta, k) = ((metal.eta[c] - fit.eta[c]).abs(), (metal.k[c] - fit.k[c]).abs());
            assert!(eta < 1e-4 && k < 1e-4, "{}: {:?} {:?}", metal.name, fit.eta, fit.k);
        }
    });
}

/// At normal incidence the table gives the color of the spectrum under D65, here computed with
/// another form of the Fresnel equations, other color matching functions and another illuminant.
#[test]
fn normal_incidence_has_the_color_of_the_spectrum() {
    each(|spectrum, metal| {
        let expected = reference_color(spectrum, 1.0);
        for c in 0..3 {
            let found = reference(1.0, metal.eta[c], metal.k[c]);
            assert!((found - metal.reflectance()[c]).abs() < 1e-12, "{}", metal.name);
            assert!((0.0..=1.0).contains(&found), "{}", metal.name);
            assert!((found - expected[c]).abs() < 0.02, "{}: {found} {expected:?}", metal.name);
        }
    });
}

/// The greatest error of a channel at any angle of the fit is 0.004.
#[test]
fn oblique_incidence_follows_the_spectrum() {
    each(|spectrum, metal| {
        let fit = fit(spectrum);
        assert!(fit.max.iter().all(|&error| error < 0.005), "{}: {:?}", metal.name, fit.max);
        for cos in [0.9, 0.7, 0.5, 0.3, 0.1] {
            let expected = reference_color(spectrum, cos);
            for c in 0..3 {
                let found = reference(cos, metal.eta[c], metal.k[c]);
                let message = format!("{} at {cos}: {found} {expected:?}", metal.name);
                assert!((found - expected[c]).abs() < 0.02, "{message}");
            }
        }
    });
}

/// Other measurements of the same metals, as R, G, B by the same derivation. Films and polished
/// samples differ, so the bound is wide: it catches a wrong spectrum, and not a digit.
#[test]
fn other_measurements_agree() {
    let others = [
        ("aluminium", [0.907, 0.916, 0.922], 0.005), // Rakic 1995
        ("copper", [0.932, 0.623, 0.522], 0.03),     // Johnson and Christy 1972
        ("gold", [0.975, 0.728, 0.365], 0.05),       // Johnson and Christy 1972
        ("iridium", [0.745, 0.732, 0.700], 0.005),   // Roberts 1986
        ("iron", [0.575, 0.567, 0.563], 0.08),       // Querry 1985
        ("molybdenum", [0.572, 0.585, 0.583], 0.03), // Kirillova et al. 1971
        ("nickel", [0.649, 0.608, 0.534], 0.05),     // Rakic et al. 1998
        ("palladium", [0.734, 0.704, 0.662], 0.02),  // Palm et al. 2018
        ("platinum", [0.679, 0.640, 0.584], 0.11),   // Rakic et al. 1998
        ("silver", [0.989, 0.984, 0.978], 0.01),     // Johnson and Christy 1972
        ("titanium", [0.542, 0.530, 0.501], 0.08),   // Mash and Motulevich 1973
        ("tungsten", [0.506, 0.497, 0.477], 0.02),   // Rakic et al. 1998
    ];
    for (name, other, bound) in others {
        let found = metal(name).expect(name).reflectance();
        for c in 0..3 {
            assert!((found[c] - other[c]).abs() < bound, "{name}: {found:?} {other:?}");
        }
    }
}

#[test]
fn names_are_unique() {
    let mut names: Vec<String> = Vec::new();
    let metals = METALS.iter().map(|metal| (metal.name, metal.aliases));
    for (name, aliases) in metals.chain(GLASSES.iter().map(|glass| (glass.name, glass.aliases))) {
        let all = std::iter::once(&name).chain(aliases);
        names.extend(all.map(|name| name.to_lowercase().replace(['-', '_', ' '], "")));
    }
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count);
    assert!(metal_names().is_sorted() && metal_names().count() >= 12);
    assert!(glass_names().is_sorted() && glass_names().count() >= 12);
}

#[test]
fn names_are_found_in_any_spelling() {
    for name in ["aluminium", "Aluminum", "AL"] {
        assert_eq!(metal(name).map(|metal| metal.name), Some("aluminium"), "{name}");
    }
    assert_eq!(metal("stainless steel"), metal("Stainless-Steel"));
    assert!(metal("stainless_steel").is_some());
    for name in ["bk7", "BK7", "N-BK7", "n_bk7"] {
        assert_eq!(glass(name).map(|glass| glass.name), Some("bk7"), "{name}");
    }
    for name in ["", "-", "a", "unobtainium", "golde"] {
        assert!(metal(name).is_none() && glass(name).is_none(), "{name}");
    }
}

/// Dispersion is normal in visible light, and the stated index is that of the formula.
#[test]
fn glasses_have_their_index() {
    for glass in GLASSES {
        let (name, found) = (glass.name, glass.index_at(D_LINE_NM));
        assert!((found - glass.ior).abs() < 1e-5, "{name}: {found}");
        assert!((glass.index_at(587.6) - glass.ior).abs() < 1e-3, "{name}");
        assert!(glass.range_nm[0] < D_LINE_NM + 2.0 && glass.range_nm[1] > 700.0, "{name}");
        let mut last = f64::INFINITY;
        for nm in (380..=780).step_by(5).map(f64::from) {
            let index = glass.index_at(nm);
            assert!((1.0..3.0).contains(&index) && index <= last, "{name} at {nm}: {index}");
            last = index;
        }
    }
}

/// Index at the d line and Abbe number `(n_d - 1) / (n_F - n_C)` of the makers' data sheets and of
/// handbooks.
#[test]
fn glasses_agree_with_their_catalogs() {
    let catalog = [
        ("bk7", 1.51680, 64.17, 0.01),
        ("f2", 1.62004, 36.37, 0.01),
        ("sf10", 1.72825, 28.41, 0.01),
        ("sf11", 1.78472, 25.76, 0.01),
        ("baf10", 1.67003, 47.11, 0.01),
        ("bak4", 1.56883, 55.98, 0.01),
        ("fk51a", 1.48656, 84.47, 0.01),
        ("lasf9", 1.85025, 32.17, 0.01),
        ("fused silica", 1.45846, 67.8, 0.1),
        ("fluorite", 1.43384, 95.0, 0.5),
        ("water", 1.3334, 55.8, 0.2),
        ("diamond", 2.4175, 55.3, 0.2),
        ("acrylic", 1.4918, 57.4, 2.5),
        ("polycarbonate", 1.585, 29.9, 2.5),
        ("polystyrene", 1.5910, 30.9, 1.5),
        ("sapphire", 1.7682, 72.2, 0.5),
    ];
    for (name, ior, abbe, bound) in catalog {
        let glass = glass(name).expect(name);
        let found = (glass.ior - 1.0) / (glass.index_at(486.1327) - glass.index_at(656.2725));
        assert!((glass.ior - ior).abs() < 1e-3, "{name}: {}", glass.ior);
        assert!((found - abbe).abs() < bound, "{name}: Abbe number {found}");
    }
}

/// A glass in a scene file: the value of `key = value` lines, or the messages of the errors.
fn loaded_glass(lines: &str) -> Result<(f64, [f64; 3]), String> {
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 1, 4]\ntarget = [0, 1, 0]\nfov = 39\n\
         [environment]\nradiance = 1\n[materials.g]\ntype = \"glass\"\n{lines}\n\
         [[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"g\"\n"
    );
    let loaded = caustica::scene::parse("glass.toml".as_ref(), text.as_bytes());
    match loaded {
        Ok(loaded) => match loaded.scene.materials[0].kind {
            caustica::scene::MaterialKind::Glass { ior, absorption, .. } => Ok((ior, absorption)),
            ref other => Err(format!("{other:?}")),
        },
        Err(errors) => Err(errors.errors.iter().map(|e| format!("{e}\n{}\n", e.label())).collect()),
    }
}

/// Theory: a name stands for its index at the d line, and light that passes the attenuation
/// distance keeps the attenuation color, so that `exp(-absorption distance)` is that color.
#[test]
fn scene_files_name_glasses() {
    for name in glass_names() {
        let (ior, _) = loaded_glass(&format!("material = \"{name}\"")).unwrap();
        assert_eq!(ior, glass(name).unwrap().ior, "{name}");
    }
    assert_eq!(loaded_glass("material = \"N-BK7\"").unwrap().0, glass("bk7").unwrap().ior);
    let color = [0.9, 0.5, 1.0];
    let lines = "ior = 1.5\nattenuation_color = [0.9, 0.5, 1.0]\nattenuation_distance = 0.25";
    let (_, absorption) = loaded_glass(lines).unwrap();
    for (absorption, color) in absorption.iter().zip(color) {
        assert!(((-absorption * 0.25).exp() - color).abs() < 1e-12, "{absorption}");
    }
    let (_, black) = loaded_glass("ior = 1.5\nattenuation_color = 0").unwrap();
    assert!(black.iter().all(|x| x.is_finite() && *x > 100.0), "{black:?}");
    for (lines, expected) in [
        ("", "lacks `ior`"),
        ("material = \"bk8\"", "did you mean `bk7`?"),
        ("ior = 1.5\nmaterial = \"bk7\"", "both an index and the name"),
        ("ior = 1.5\nabsorption = 1\nattenuation_color = 0.5", "two kinds of absorption"),
        ("ior = 1.5\nabsorption = 1\nattenuation_distance = 2", "two kinds of absorption"),
        ("ior = 1.5\nattenuation_distance = 2", "distance without a color"),
        ("ior = 1.5\nattenuation_color = 0.5\nattenuation_distance = 0", "attenuation_distance"),
    ] {
        let message = loaded_glass(lines).unwrap_err();
        assert!(message.contains(expected), "{lines}: {message}");
    }
}

/// The first material of a scene with `lines` as the material `m`, or the messages of the errors.
fn loaded_material(lines: &str) -> Result<caustica::scene::MaterialKind, String> {
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 1, 4]\ntarget = [0, 1, 0]\nfov = 39\n\
         [environment]\nradiance = 1\n[materials.m]\n{lines}\n[materials.w]\n\
         type = \"glass\"\nior = 1.3\n[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\n\
         radius = 1\nmaterial = \"m\"\n[[shapes]]\ntype = \"sphere\"\ncenter = [3, 0, 0]\n\
         radius = 1\nmaterial = \"w\"\n"
    );
    match caustica::scene::parse("m.toml".as_ref(), text.as_bytes()) {
        Ok(loaded) => Ok(loaded.scene.materials[0].kind.clone()),
        Err(errors) => Err(errors.errors.iter().map(|e| format!("{e}\n{}\n", e.label())).collect()),
    }
}

/// Theory: a metal's name stands for its index, and whatever contradicts itself or has no meaning
/// is an error that says what to do.
#[test]
fn scene_files_name_metals_and_compose_materials() {
    use caustica::low_level::scene::named::metals::{metal, metal_names};
    use caustica::scene::MaterialKind;
    for name in metal_names() {
        let kind = loaded_material(&format!("type = \"metal\"\nmaterial = \"{name}\"")).unwrap();
        let metal = metal(name).unwrap();
        let expected = MaterialKind::Conductor { eta: metal.eta, k: metal.k, roughness: 0.0 };
        assert_eq!(kind, expected, "{name}");
    }
    for (lines, expected) in [
        ("type = \"metal\"\nroughness = 0.2", "lacks `reflectance`"),
        ("type = \"metal\"\nmaterial = \"gild\"", "did you mean `gold`?"),
        ("type = \"metal\"\nmaterial = \"gold\"\nreflectance = 0.5", "given in several ways"),
        ("type = \"metal\"\neta = 1.2", "`eta` without `k`"),
        ("type = \"metal\"\nk = 1.2", "`k` without `eta`"),
        ("type = \"metal\"\neta = 0\nk = 1", "eta"),
        ("type = \"plastic\"\nreflectance = 0.5\nior = 1", "ior"),
        ("type = \"glass\"\nior = 1.5\nthin = true\npriority = 1", "`priority` has no meaning"),
        ("type = \"glass\"\nior = 1.5\ntransmittance = 0.5", "`transmittance` has no meaning"),
        ("type = \"glass\"\nior = 1.5\nopacity = 0.5", "glass with an opacity"),
        ("type = \"mirror\"\nreflectance = 1\nopacity_cutoff = 0.5", "cutoff without an opacity"),
        ("type = \"mirror\"\nreflectance = 1\nopacity = \"leaf\"", "texture `leaf` is not defined"),
        ("type = \"mix\"\nmaterials = [\"m\", \"m\"]\namount = 0.5", "contains itself"),
        ("type = \"mix\"\nmaterials = [\"n\", \"m\"]\namount = 0.5", "material `n` is not defined"),
        ("type = \"two_sided\"\nfront = \"w\"\nback = \"w\"", "contains glass"),
        ("type = \"null\"\nopacity = 0.5", "opacity"),
    ] {
        let message = loaded_material(lines).unwrap_err();
        assert!(message.contains(expected), "{lines}: {message}");
    }
}
