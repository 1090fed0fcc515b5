// A Van der Pol oscillator with internal Runge-Kutta steps, driven by its input.
// u Real input
// mu Real parameter 1.5
// x Real output
// v Real output
// energy Real local
static double slope(double mu_, double x_, double v_, double u_) { return mu_ * (1 - x_ * x_) * v_ - x_ + u_; }
static fmi2Status leave(Model *m) { x = 1 + u; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    for (int k = 0; k < 4; k++) {
        double d = h / 4, a = v, b = slope(mu, x, v, u);
        double c = v + d / 2 * b, e = slope(mu, x + d / 2 * a, v + d / 2 * b, u);
        double f = v + d / 2 * e, g = slope(mu, x + d / 2 * c, v + d / 2 * e, u);
        double i = v + d * g, j = slope(mu, x + d * f, v + d * g, u);
        x += d / 6 * (a + 2 * c + 2 * f + i);
        v += d / 6 * (b + 2 * e + 2 * g + j);
    }
    energy = 0.5 * (x * x + v * v);
    return fmi2OK;
}
