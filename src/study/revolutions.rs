//! Replacement of surfaces of revolution by meshes, and coarser Newton tolerances, for studies of
//! the cost of exact surfaces.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::accel::tessellate::{Fineness, RevolutionMesh, tessellate};
use crate::scene::{Mesh, Scene, ShapeKind, Triangle};

/// Representation of surfaces of revolution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Revolutions {
    /// Exact Bezier profiles.
    #[default]
    Exact,
    /// Mesh of `caustica tessellate` with this number of sectors, and smooth normals.
    Sectors(u32),
}

/// Stop condition of the ray intersection with an exact surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Newton {
    /// Smallest tolerance that the precision allows.
    #[default]
    Least,
    /// Stop after a Newton step shorter than this, relative to the size of the profile.
    Tolerance(f64),
}

impl FromStr for Revolutions {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse::<u32>()) {
            ("exact", _) => Ok(Self::Exact),
            (_, Ok(sectors)) if (3..=4096).contains(&sectors) => Ok(Self::Sectors(sectors)),
            _ => Err("expected exact, or a number of sectors from 3 to 4096".to_owned()),
        }
    }
}

impl fmt::Display for Revolutions {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Exact => write!(f, "exact"),
            Self::Sectors(sectors) => write!(f, "{sectors}"),
        }
    }
}

impl FromStr for Newton {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse::<f64>()) {
            ("least", _) => Ok(Self::Least),
            (_, Ok(length)) if (1e-7..=1.0).contains(&length) => Ok(Self::Tolerance(length)),
            _ => Err("expected least, or a length from 1e-7 to 1 in profile sizes".to_owned()),
        }
    }
}

impl fmt::Display for Newton {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Least => write!(f, "least"),
            Self::Tolerance(length) => write!(f, "{length:e}"),
        }
    }
}

const NONE_HERE: &str = "the scene has no surface of revolution";

/// Changes the representation of all surfaces of revolution in a scene.
///
/// # Errors
/// A message, if the scene has no such surface or a profile cannot be tessellated.
pub fn with_revolutions(scene: &Scene, revolutions: Revolutions) -> Result<Scene, String> {
    let mut scene = scene.clone();
    let mut found = false;
    for shape in &mut scene.shapes {
        let ShapeKind::Revolution { segments, transform, .. } = &shape.kind else { continue };
        found = true;
        if let Revolutions::Sectors(sectors) = revolutions {
            let mesh = tessellate(segments, &Fineness::of_sectors(sectors))
                .map_err(|error| error.to_string())?
                .transformed(transform);
            shape.kind = ShapeKind::Mesh(smooth(mesh));
        }
    }
    if found { Ok(scene) } else { Err(NONE_HERE.to_owned()) }
}

/// Changes the Newton tolerance of all exact surfaces of revolution in a scene.
///
/// # Errors
/// A message, if the scene has no such surface.
pub fn with_newton(scene: &Scene, newton: Newton) -> Result<Scene, String> {
    let mut scene = scene.clone();
    let mut found = false;
    for shape in &mut scene.shapes {
        if let ShapeKind::Revolution { newton_tolerance, .. } = &mut shape.kind {
            found = true;
            *newton_tolerance = match newton {
                Newton::Least => 0.0,
                Newton::Tolerance(length) => length,
            };
        }
    }
    if found { Ok(scene) } else { Err(NONE_HERE.to_owned()) }
}

fn smooth(mesh: RevolutionMesh) -> Mesh {
    let column = |t: &[[u32; 3]; 3], of: usize| t.map(|corner| corner[of]);
    let triangle = |t: &[[u32; 3]; 3]| Triangle {
        position: column(t, 0),
        uv: Some(column(t, 1)),
        normal: Some(column(t, 2)),
    };
    Mesh {
        triangles: mesh.triangles.iter().map(triangle).collect(),
        positions: mesh.positions,
        normals: mesh.normals,
        uvs: mesh.uvs,
    }
}

/// Theory: the mesh of the paraboloid r^2 = y, open at the top, has its vertices on the surface and
/// its faces within the sagitta of a chord, which is inversely proportional to the square of the
/// number of sectors.
#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const SCENE: &str = r#"
version = 1
[camera]
position = [0.0, 0.0, 5.0]
target = [0.0, 0.0, 0.0]
fov = 40.0
[materials.white]
type = "diffuse"
reflectance = 0.5
[[shapes]]
type = "revolution"
profile = [[0.0, 0.0], [0.5, 0.0], [1.0, 1.0]]
material = "white"
transform = { scale = 2.0, translate = [0.0, 3.0, 0.0] }
[[shapes]]
type = "sphere"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "white"
"#;

    fn scene(text: &str) -> Scene {
        crate::scene::parse("bowl.toml".as_ref(), text.as_bytes()).unwrap().scene
    }

    /// Largest distance of centers of faces and edges from the paraboloid
    /// x^2 + z^2 = 2 (y - 3).
    fn off(scene: &Scene) -> f64 {
        let ShapeKind::Mesh(mesh) = &scene.shapes[0].kind else { panic!("no mesh") };
        let height = |p: DVec3| (0.5 * (p.x * p.x + p.z * p.z) + 3.0 - p.y).abs();
        assert!(mesh.positions.iter().all(|p| height(*p) < 1e-12));
        let mut most = 0.0f64;
        for t in &mesh.triangles {
            let [a, b, c] = t.position.map(|i| mesh.positions[i as usize]);
            most = most
                .max(height((a + b) / 2.0))
                .max(height((b + c) / 2.0))
                .max(height((a + b + c) / 3.0));
            // smooth normals are those of the surface, along (x, -1, z)
            for (p, n) in t.position.iter().zip(t.normal.unwrap()) {
                let (p, n) = (mesh.positions[*p as usize], mesh.normals[n as usize]);
                assert!(n.cross(DVec3::new(p.x, -1.0, p.z).normalize()).length() < 1e-9);
            }
        }
        most
    }

    #[test]
    fn meshes_replace_revolutions() {
        let own = scene(SCENE);
        let with = |sectors| with_revolutions(&own, Revolutions::Sectors(sectors)).unwrap();
        let errors = [16, 32, 64].map(|sectors| off(&with(sectors)));
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((2.5..6.0).contains(&ratio), "{errors:?}");
        }
        assert_eq!(with(16).shapes[1], own.shapes[1], "other shapes are unchanged");
        assert_eq!(with(16).shapes[0].material, own.shapes[0].material);
        assert_eq!(with_revolutions(&own, Revolutions::Exact).unwrap(), own);
        let ball = scene(&SCENE[..SCENE.find("[[shapes]]").unwrap()]);
        assert_eq!(with_revolutions(&ball, Revolutions::Sectors(16)).unwrap_err(), NONE_HERE);
        assert_eq!(with_newton(&ball, Newton::Tolerance(0.1)).unwrap_err(), NONE_HERE);
    }

    #[test]
    fn words_and_numbers_read_back() {
        for text in ["exact", "3", "4096"] {
            assert_eq!(text.parse::<Revolutions>().unwrap().to_string(), text);
        }
        for text in ["least", "1e-7", "1e-3"] {
            assert_eq!(text.parse::<Newton>().unwrap().to_string(), text);
        }
    }

    /// Newton's method converges quadratically: a last step of 1e-3 leaves an error near 1e-6, one
    /// of 1e-1 near 1e-2. The smallest tolerance is the default of scene files.
    #[test]
    fn a_tolerance_reaches_the_patches() {
        let own = scene(SCENE);
        let patches = |scene: &Scene| crate::pilots::prepare(scene, 8, 8).unwrap().tables.patches;
        let least = patches(&own)[0].step_tolerance;
        assert_eq!(least, crate::shapes::revolution_roots::STEP_TOLERANCE);
        let with = |newton| patches(&with_newton(&own, newton).unwrap())[0].step_tolerance;
        assert_eq!(with(Newton::Tolerance(1e-3)), 1e-3);
        assert_eq!((with(Newton::Least), with(Newton::Tolerance(1e-7))), (least, least));
    }
}
