within MachiningFMUs.Examples;
model Lens "A diamond tool on an arm follows a toric lens, two strokes in each revolution"
  parameter Real hub(unit = "kg.m2") = 4.5e-4 "Inertia of motor, encoder and hub";
  parameter Real arm(unit = "kg.m2") = 3.5e-4 "Inertia of the arm beyond the flexure";
  parameter Real flexure(unit = "rad/s", displayUnit = "Hz") = 7539.8 "Resonance of the arm with the hub held";
  parameter Real friction(unit = "N.m.s/rad") = 2e-3 "Viscous friction";
  parameter Real speed(unit = "rad/s", displayUnit = "rev/min") = 62.831853 "Speed of the spindle";
  parameter Real place(unit = "m", displayUnit = "mm") = 0.04 "Position of the slide";
  Real angle(unit = "rad", displayUnit = "deg", start = 0.0, fixed = true) "Angle of the hub, at the encoder";
  Real velocity(unit = "rad/s", start = 0.0, fixed = true);
  Real tip(unit = "rad", displayUnit = "deg", start = 0.0, fixed = true) "Angle of the tool";
  Real tipVelocity(unit = "rad/s", start = 0.0, fixed = true);
  Real bending(unit = "N.m") "Torque of the flexure";
  MachiningFMUs.RotaryFastToolServo controller;
equation
  bending = arm*(flexure^2*(angle - tip) + 0.04*flexure*(velocity - tipVelocity));
  der(angle) = velocity;
  der(tip) = tipVelocity;
  hub*der(velocity) = controller.torque - friction*velocity - bending;
  arm*der(tipVelocity) = bending;
  controller.arm_angle = angle;
  controller.spindle_angle = speed*time;
  controller.slide_position = place;
  controller.mode = Integer(MachiningFMUs.RotaryFastToolServo.Mode.Track);
  controller.enable = true;
  controller.commission = false;
  controller.reset_fault = false;
  controller.feedforward_enable = true;
  controller.afc_enable = true;
  controller.hold_angle = 0.0;
  controller.probe_depth = 0.0;
  controller.probe_lateral = 0.0;
  controller.probe_angle = 0.0;
  controller.probe_capture = false;
  controller.calibration_cut = false;
  controller.calibration_solve = false;
  annotation (
    experiment(StopTime = 1.0, Interval = 1e-4, Tolerance = 1e-8),
    Documentation(info = "<html><p>After 0.3 s the arm is on the path: <code>controller.error_tracking</code> falls below 1 um,
      while <code>controller.reference_depth</code> moves by more than 3 mm.</p></html>"));
end Lens;
