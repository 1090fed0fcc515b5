within MachiningFMUs.Examples;
model Contact "A tool approaches a workpiece, stops at the contact and retracts"
  parameter Real mass(unit = "kg") = 10.4 "Moving mass of the slide";
  parameter Real thrust(unit = "N/A") = 19.4 "Thrust per current";
  parameter Real stiffness(unit = "N/m") = 2e5 "Stiffness of the contact";
  parameter Real surface(unit = "m", displayUnit = "um") = 1.2e-4 "Distance to the surface";
  parameter Real noise(unit = "m", displayUnit = "nm") = 5e-10 "Standard deviation of the encoder noise";
  Real position(unit = "m", start = 0.0, fixed = true) "Position of the slide";
  Real velocity(unit = "m/s", start = 0.0, fixed = true) "Velocity of the slide";
  Real force(unit = "N") "Force of the contact";
  MachiningFMUs.DisturbanceObserverContactDetection controller;
protected
  discrete Integer seed(start = 1, fixed = true) "Seed of the noise generator";
equation
  when sample(0.0, controller.sample_period) then
    seed = mod(16807*pre(seed), 65521);
  end when;
  force = if position > surface then stiffness*(position - surface) else 0.0;
  der(position) = velocity;
  mass*der(velocity) = thrust*controller.current - force;
  // uniform noise with the same standard deviation
  controller.position = position + noise*sqrt(12.0)*(seed/65521.0 - 0.5);
  controller.position_valid = true;
  controller.spindle_speed = 3141.6;
  controller.enable = time > 0.01;
  controller.commission = false;
  controller.calibrate = false;
  controller.reset_fault = false;
  annotation (
    experiment(StopTime = 2.0, Interval = 1e-4, Tolerance = 1e-8),
    Documentation(info = "<html><p>The controller learns the noise during the approach, detects the contact within a micrometer and retracts:
      <code>controller.state</code> ends at 7, <code>Done</code>.</p></html>"));
end Contact;
