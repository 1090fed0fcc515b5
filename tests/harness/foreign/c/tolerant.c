// A pendulum whose number of internal steps follows from the tolerance of the experiment.
// torque Real input
// angle Real output
// rate Real output
// inner Integer output
static fmi2Status leave(Model *m) {
    angle = 0.3;
    inner = m->tolerance > 0 && m->tolerance < 1e-3 ? 32 : 4;
    return fmi2OK;
}
static fmi2Status step(Model *m, double t, double h) {
    for (int k = 0; k < inner; k++) {
        rate += h / inner * (torque - 9.81 * sin(angle));
        angle += h / inner * rate;
    }
    return fmi2OK;
}
