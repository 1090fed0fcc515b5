// A gain that may change during a run, and a parameter that is calculated at the start.
// u Real input
// gain Real parameter 2 tunable
// scale Real parameter 0.25
// product Real calculatedParameter
// y Real output
// sum Real output
static fmi2Status leave(Model *m) { product = gain * scale; y = product * u; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) { y = gain * scale * u; sum += product * h; return fmi2OK; }
