// A generator of pseudo-random numbers with a seed.
// seed Integer parameter 7
// sigma Real parameter 0.5
// y Real output
static fmi2Status leave(Model *m) { m->state[0] = seed; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    unsigned x = (unsigned)m->state[0] * 1664525u + 1013904223u;
    m->state[0] = x;
    y = sigma * (x / 4294967296.0 - 0.5);
    return fmi2OK;
}
