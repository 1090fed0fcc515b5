// A transport delay of 12 steps, filled with the input of the initialization mode.
// u Real input
// y Real output
// full Boolean output
static fmi2Status leave(Model *m) {
    for (int k = 0; k < 12; k++) m->state[k] = u;
    y = u;
    return fmi2OK;
}
static fmi2Status step(Model *m, double t, double h) {
    int k = (int)m->state[20]++;
    y = m->state[k % 12];
    m->state[k % 12] = u;
    full = k >= 11;
    return fmi2OK;
}
