// Camera rays: projections and thin lens. Twin: src/camera.rs.

//#if projection
const ORTHOGRAPHIC: u32 = 1u;
const PANORAMA: u32 = 2u;
const FISHEYE: u32 = 3u;
//#end

fn camera_ray(camera: Camera, x: u32, y: u32, u: vec4f) -> Ray {
    let px = 2.0 * (f32(x) + u.x) / f32(camera.width) - 1.0;
    let py = 1.0 - 2.0 * (f32(y) + u.y) / f32(camera.height);
    //#if projection
    switch camera.projection {
        case ORTHOGRAPHIC: {
            let origin = camera.position + camera.right * px + camera.up * py;
            return through_lens(camera, origin, camera.forward, u);
        }
        case PANORAMA: {
            return panorama_ray(camera, px, py);
        }
        case FISHEYE: {
            return fisheye_ray(camera, px, py);
        }
        default: {}
    }
    //#end
    let d = camera.center + camera.right * px + camera.up * py;
    return through_lens(camera, camera.position, d, u);
}

fn through_lens(camera: Camera, origin: vec3f, d: vec3f, u: vec4f) -> Ray {
    var start = origin;
    var direction = d;
    //#if lens
    let lens = sample_disc(vec2f(u.z, u.w)) * camera.aperture;
    let right = camera.lens_right * lens.x;
    let up = camera.lens_up * lens.y;
    start = origin + right + up;
    direction = d * camera.focus - right - up;
    //#end
    return Ray(start, 0.0, unit(direction), FAR);
}

//#if projection
fn panorama_ray(camera: Camera, px: f32, py: f32) -> Ray {
    let x = sin_cos(PI * px);
    let y = sin_cos(0.5 * PI * py);
    let across = camera.forward * x.y + camera.lens_right * x.x;
    let direction = across * y.y + camera.lens_up * y.x;
    return Ray(camera.position, 0.0, unit(direction), FAR);
}

fn fisheye_ray(camera: Camera, px: f32, py: f32) -> Ray {
    let v = camera.right * px + camera.up * py;
    let angle = sqrt(dot(v, v));
    let sc = sin_cos(angle);
    var share = 1.0;
    if angle > 0.0 {
        share = sc.x / angle;
    }
    let direction = camera.forward * sc.y + v * share;
    let t_max = select(FAR, 0.0, angle > camera.focus);
    return Ray(camera.position, 0.0, unit(direction), t_max);
}
//#end

fn footprint(camera: Camera, length: f32) -> f32 {
    //#if projection
    if camera.projection == ORTHOGRAPHIC {
        return camera.pixel;
    }
    //#end
    return camera.pixel * length;
}

//#if projection
fn sees_around(camera: Camera) -> bool {
    return camera.projection == PANORAMA || camera.projection == FISHEYE;
}
//#end
