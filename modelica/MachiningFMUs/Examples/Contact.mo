within MachiningFMUs.Examples;
model Contact "A tool is driven against a workpiece, stopped by its contact and drawn back"
  parameter Real mass(unit = "kg") = 10.4 "Moving mass of the slide";
  parameter Real thrust(unit = "N/A") = 19.4 "Thrust per current";
  parameter Real stiffness(unit = "N/m") = 2e5 "Stiffness of the contact";
  parameter Real surface(unit = "m", displayUnit = "um") = 1.2e-4 "Way to the surface";
  parameter Real noise(unit = "m", displayUnit = "nm") = 5e-10 "Noise of the encoder, deviation";
  Real position(unit = "m", start = 0.0, fixed = true) "Position of the slide";
  Real velocity(unit = "m/s", start = 0.0, fixed = true) "Velocity of the slide";
  Real force(unit = "N") "Force of the contact";
  MachiningFMUs.DisturbanceObserverContactDetection controller;
protected
  discrete Integer seed(start = 1, fixed = true) "Of the noise, by a congruence";
equation
  when sample(0.0, controller.sample_period) then
    seed = mod(16807*pre(seed), 65521);
  end when;
  force = if position > surface then stiffness*(position - surface) else 0.0;
  der(position) = velocity;
  mass*der(velocity) = thrust*controller.current - force;
  // even noise of the same deviation
  controller.position = position + noise*sqrt(12.0)*(seed/65521.0 - 0.5);
  controller.position_valid = true;
  controller.spindle_speed = 3141.6;
  controller.enable = time > 0.01;
  controller.commission = false;
  controller.teach = false;
  controller.reset_fault = false;
  annotation (
    experiment(StopTime = 2.0, Interval = 1e-4, Tolerance = 1e-8),
    Documentation(info = "<html><p>The controller learns the noise on the way, finds the contact within a micrometre and goes back:
      <code>controller.state</code> should end at 7, <code>Done</code>.</p></html>"));
end Contact;
