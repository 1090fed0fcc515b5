// Asks for the end of the simulation after 20 steps.
// u Real input
// y Real output
static fmi2Status leave(Model *m) { return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    if (m->state[0]++ == 20) {
        m->ended = fmi2True;
        m->last = t;
        return fmi2Discard;
    }
    y += h * (1 + u);
    return fmi2OK;
}
