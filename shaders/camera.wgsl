// Pinhole and thin-lens camera. Twin: src/camera.rs.

fn camera_ray(camera: Camera, x: u32, y: u32, u: vec4f) -> Ray {
    let px = 2.0 * (f32(x) + u.x) / f32(camera.width) - 1.0;
    let py = 1.0 - 2.0 * (f32(y) + u.y) / f32(camera.height);
    let d = camera.forward + camera.right * px + camera.up * py;
    var origin = camera.position;
    var direction = d;
    //#if lens
    let lens = sample_disc(vec2f(u.z, u.w)) * camera.aperture;
    let right = camera.lens_right * lens.x;
    let up = camera.lens_up * lens.y;
    origin = camera.position + right + up;
    direction = d * camera.focus - right - up;
    //#end
    return Ray(origin, 0.0, unit(direction), FAR);
}
