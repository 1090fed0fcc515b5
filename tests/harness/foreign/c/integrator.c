// Two integrators in series, with the time of the communication point.
// u Real input
// gain Real parameter 2.5
// speed Real output
// way Real output
// clock Real output
static fmi2Status leave(Model *m) { clock = m->start; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    way += h * (speed + 0.5 * h * gain * u);
    speed += h * gain * u;
    clock = t + h;
    return fmi2OK;
}
