// Returns a warning in every tenth step.
// u Real input
// y Real output
static fmi2Status leave(Model *m) { return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    int k = (int)m->state[0]++;
    y = y / 2 + u;
    if (k % 10 == 9) {
        LOG(m, fmi2Warning, "step %d", k);
        return fmi2Warning;
    }
    return fmi2OK;
}
