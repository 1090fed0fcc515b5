// Prepares its results for the whole time, so it needs the stop time.
// option NEEDS_STOP
// y Real output
// horizon Real output
// u Real input
static fmi2Status leave(Model *m) { horizon = m->stop; y = u; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) { y = u * (1 - t / m->stop); return fmi2OK; }
