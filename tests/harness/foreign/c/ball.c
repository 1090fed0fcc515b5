// A bouncing ball with fixed internal steps; no inputs.
// height Real output
// speed Real output
// bounces Integer output
// restitution Real parameter 0.8
static fmi2Status leave(Model *m) { height = 1; return fmi2OK; }
static fmi2Status step(Model *m, double t, double h) {
    for (int k = 0; k < 10; k++) {
        speed -= 9.81 * h / 10;
        height += speed * h / 10;
        if (height < 0 && speed < 0) {
            height = 0;
            speed *= -restitution;
            bounces++;
        }
    }
    return fmi2OK;
}
