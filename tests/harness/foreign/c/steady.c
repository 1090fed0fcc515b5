// A lag that starts in the steady state of its input.
// u Real input 0.5
// y Real output
// pole Real parameter 0.2
// slope Real local
static fmi2Status leave(Model *m) { y = u; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    slope = (u - y) / pole;
    y += (u - y) * (1 - exp(-h / pole));
    return fmi2OK;
}
