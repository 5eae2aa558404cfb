mod revolution;
use caustica::build::revolution::Placement;
use caustica::shapes::revolution::*;
use glam::Vec3;
use revolution::profiles::{place, profiles};
#[test]
fn dbg() {
    let p = place(&profiles()[2], &Placement::default());
    let t=&p.tables;
    for q in &t.patches { println!("{q:?} {:?}", &t.profile_points[q.first_point as usize..][..=q.degree as usize]); }
    for q in &t.patches {
        println!("{:?}", intersect_patch(&t.profile_points,&t.revolutions[0],q,Vec3::new(1.9162117, 2.0160928, -1.6647971), Vec3::new(-0.49744108, -0.6836243, 0.5340507),0.0,1e30));
    }
}
