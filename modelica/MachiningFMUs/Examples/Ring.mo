within MachiningFMUs.Examples;
model Ring "A pusher centers a ring on a turning table"
  parameter Real mass(unit = "kg") = 1.0 "Mass of the ring";
  parameter Real radius(unit = "m", displayUnit = "mm") = 0.05 "Outer radius of the ring";
  parameter Real eccentricity(unit = "m", displayUnit = "um") = 5e-4 "Distance of the ring from the axis at the start";
  parameter Real friction = 0.16 "Friction of the ring on the table";
  parameter Real creep(unit = "m/s") = 2e-6 "Slip speed below which the friction is viscous";
  parameter Real speed(unit = "rad/s", displayUnit = "rev/min") = 2.0943951 "Speed of the table";
  parameter Real stiffness(unit = "N/m") = 5e6 "Stiffness of the pusher";
  parameter Real damping(unit = "N.s/m") = 670.0 "Damping of the pusher";
  parameter Real distance(unit = "m", displayUnit = "mm") = 0.03 "From the free probe to a centered ring, at the start";
  parameter Real pusher(unit = "m", displayUnit = "mm") = 0.02 "Collapse of the probe at which the pusher touches";
  parameter Real stroke(unit = "m", displayUnit = "mm") = 0.025 "Stroke of the probe";
  parameter Real bandwidth(unit = "rad/s", displayUnit = "Hz") = 251.3 "Natural frequency of the slide's servo";
  Real x(unit = "m", start = eccentricity, fixed = true) "Center of the ring, along the slide";
  Real y(unit = "m", start = 0.0, fixed = true) "Center of the ring, across the slide";
  Real vx(unit = "m/s", start = 0.0, fixed = true);
  Real vy(unit = "m/s", start = speed*eccentricity, fixed = true);
  Real slide(unit = "m", start = 0.0, fixed = true) "Position of the slide, positive towards the axis";
  Real slideVelocity(unit = "m/s", start = 0.0, fixed = true);
  Real collapse(unit = "m") "Collapse of the probe, without its end stop";
  Real force(unit = "N") "Force of probe and pusher on the ring";
  Real slip(unit = "m/s") "Slip velocity of the ring on the table";
  Real error(unit = "m", displayUnit = "um") "Distance of the ring from the axis";
  MachiningFMUs.RingCentering controller;
protected
  Real across(unit = "m") "Distance from the center of the ring to its contact point, along the slide";
equation
  across = sqrt(radius^2 - y^2);
  collapse = x + across - (radius + distance - slide);
  force = (if collapse > 0.0 then 0.35 + 0.35*min(collapse, stroke)/stroke else 0.0)
    + (if collapse > pusher then max(0.0, stiffness*(collapse - pusher) + damping*(vx + slideVelocity)) else 0.0);
  slip = sqrt((vx + speed*y)^2 + (vy - speed*x)^2 + creep^2);
  der(x) = vx;
  der(y) = vy;
  mass*der(vx) = -force*across/radius - friction*mass*9.81*(vx + speed*y)/slip;
  mass*der(vy) = force*y/radius - friction*mass*9.81*(vy - speed*x)/slip;
  der(slide) = slideVelocity;
  der(slideVelocity) = bandwidth^2*(controller.slide_position_setpoint - slide)
    + 1.4*bandwidth*(controller.slide_velocity_setpoint - slideVelocity);
  error = sqrt(x^2 + y^2);
  controller.spindle_angle = speed*time;
  controller.slide_position = slide;
  controller.probe_position = min(max(collapse, 0.0), stroke);
  controller.enable = time > 0.01;
  controller.commission = false;
  controller.reset_fault = false;
  annotation (
    experiment(StopTime = 15.0, Interval = 1e-3, Tolerance = 1e-8),
    Documentation(info = "<html><p>The ring is followed by a probe and pushed when its far side comes round, until
      <code>controller.centered</code> is true and <code>error</code> below 2.5 um.</p></html>"));
end Ring;
