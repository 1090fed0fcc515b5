within MachiningFMUs.Examples;
model Edge "A robot removes the burr of an edge, at the maximum speed of its tool"
  parameter Real natural(unit = "rad/s") = 280.0 "Natural frequency of the velocity loop of an axis";
  parameter Real damping = 0.52 "Damping of the velocity loop of an axis";
  parameter Real idle(unit = "rad/s", displayUnit = "rev/min") = 1885.0 "Speed of the tool in air";
  parameter Real droop(unit = "rad/m3") = 2e8 "Speed drop of the tool for each volume that it removes in a second";
  parameter Real lag(unit = "s") = 0.02 "Time constant of the tool's speed";
  Real position[6](each start = 0.0, each fixed = true) "Positions of the axes, rad and m";
  Real velocity[6](each start = 0.0, each fixed = true);
  Real acceleration[6](each start = 0.0, each fixed = true);
  Real spindle(unit = "rad/s", displayUnit = "rev/min", start = idle, fixed = true) "Speed of the tool";
  Real burr(unit = "m2") "Cross-section of the burr at the tool";
  MachiningFMUs.VariableSpeedDeburring controller(bank_compute = true);
protected
  Real command[6] "Velocity commands of the controller";
equation
  command = {controller.axis1_velocity, controller.axis2_velocity, controller.axis3_velocity,
    controller.axis4_velocity, controller.axis5_velocity, controller.axis6_velocity};
  der(position) = velocity;
  der(velocity) = acceleration;
  der(acceleration) = natural^2*(command - velocity) - 2.0*damping*natural*acceleration;
  burr = if controller.state == Integer(MachiningFMUs.VariableSpeedDeburring.State.Run)
    and controller.path_distance > 0.01 and controller.path_distance < 0.25
    then 1.5e-3*(3.5e-3 + 1e-3*sin(125.66*controller.path_distance)) else 0.0;
  lag*der(spindle) = idle - droop*controller.load_feed*burr - spindle;
  controller.axis1_position = position[1];
  controller.axis2_position = position[2];
  controller.axis3_position = position[3];
  controller.axis4_position = position[4];
  controller.axis5_position = position[5];
  controller.axis6_position = position[6];
  controller.spindle_speed = spindle;
  controller.mode = Integer(MachiningFMUs.VariableSpeedDeburring.Mode.Deburr);
  controller.enable = time > 0.05;
  controller.hold = false;
  controller.speed_override = 1.0;
  controller.commission = false;
  controller.register = false;
  controller.contact = false;
  controller.reset_fault = false;
  annotation (
    experiment(StopTime = 12.0, Interval = 1e-2, Tolerance = 1e-8),
    Documentation(info = "<html><p>The path is the built-in test piece, and its patterns are computed from the nominal drive.
      In the burr <code>controller.load_feed</code> keeps the tool near 17,300 rpm. The cycle ends in state 7, <code>Done</code>.</p></html>"));
end Edge;
