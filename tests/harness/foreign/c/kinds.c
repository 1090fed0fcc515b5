// Variables of all types; `mode` is an enumeration.
// on Boolean input
// count Integer input 3
// mode Enumeration input 1
// u Real input
// text String parameter abc
// off Boolean output
// total Integer output
// mode_out Enumeration output
// y Real output
// last Boolean local
static fmi2Status leave(Model *m) { off = !on; total = 0; mode_out = mode; y = (double)strlen(m->text); return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    off = !on;
    total += on ? count : -1;
    mode_out = mode;
    y = mode == 2 ? -u : u;
    last = on;
    return fmi2OK;
}
