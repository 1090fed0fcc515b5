// A PID controller with limits and anti-windup.
// setpoint Real input
// measured Real input
// enable Boolean input
// output Real output
// saturated Boolean output
// integral Real local
// kp Real parameter 3
// ki Real parameter 1.5
// kd Real parameter 0.1
// limit Real parameter 0.8
static fmi2Status leave(Model *m) { m->state[0] = setpoint - measured; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    double error = setpoint - measured, raw = kp * error + integral + kd * (error - m->state[0]) / h;
    m->state[0] = error;
    if (!enable) integral = raw = 0;
    output = fmax(-limit, fmin(limit, raw));
    saturated = output != raw;
    if (!saturated && enable) integral += ki * h * error;
    return fmi2OK;
}
