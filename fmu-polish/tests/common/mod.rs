//! CL data of a spiral in a spherical hollow.

/// Radius of the hollow, m.
pub const HOLLOW: f64 = 3e-3;

/// Contact point and normal (mm) at the distance `r` (mm) from the axis and the angle `a` (rad).
pub fn row(r: f64, a: f64) -> [f64; 6] {
    let hollow = 1e3 * HOLLOW;
    let (x, y) = (r * a.cos(), r * a.sin());
    let rise = (hollow * hollow - r * r).sqrt();
    [x, y, hollow - rise, -x / hollow, -y / hollow, rise / hollow]
}

/// A spiral of `count` points, 20 um apart, the windings 0.1 mm.
pub fn spiral(count: usize) -> Vec<[f64; 6]> {
    let (mut r, mut a) = (0.05, 0.0);
    let mut rows = Vec::with_capacity(count);
    for _ in 0..count {
        rows.push(row(r, a));
        let angle = 0.02 / r;
        a += angle;
        r += 0.1 * angle / std::f64::consts::TAU;
    }
    rows
}

/// A whole CL file with these points.
pub fn file(rows: &[[f64; 6]]) -> String {
    let mut text = String::from("PARTNO/HOLLOW\nUNITS/MM\nCUTTER/1\nFEDRAT/120,MMPM\n");
    for [x, y, z, i, j, k] in rows {
        text += &format!("GOTO/{x:.6},{y:.6},{z:.6},{i:.7},{j:.7},{k:.7}\n");
    }
    text + "FINI\n"
}
