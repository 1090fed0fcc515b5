within MachiningFMUs.Examples;
model Mold "A ball polishes a mold with 5 N"
  parameter Real stiffness(unit = "N/m") = 1.78e5 "Stiffness of tip and contact";
  parameter Real friction = 0.2 "Friction of the ball on the mold";
  parameter Real natural(unit = "rad/s", displayUnit = "Hz") = 754.0 "Natural frequency of the velocity loop of an axis";
  parameter Real damping = 0.7 "Damping of the velocity loop of an axis";
  parameter Real higher(unit = "m", displayUnit = "um") = 3e-5 "Height of the mold above its path";
  parameter Real above(unit = "m", displayUnit = "mm") = 1e-3 "Height of the ball above the path at the start";
  parameter Real noise(unit = "N") = 0.05 "Standard deviation of the noise of the force sensor";
  Real position[3](each unit = "m", start = {0.0, 0.0, above}, each fixed = true) "Center of the ball";
  Real velocity[3](each unit = "m/s", each start = 0.0, each fixed = true);
  Real acceleration[3](each unit = "m/s2", each start = 0.0, each fixed = true);
  Real depth(unit = "m", displayUnit = "um") "Depth of the ball in the mold, which bends the tip";
  Real force[3](each unit = "N") "Force on the ball";
  MachiningFMUs.StickSlipPolishing controller;
protected
  Real normal[3] "Normal of the mold, from the path";
  Real desired[3](each unit = "m") "Center of the ball on the path";
  Real slide[3](each unit = "m/s") "Velocity along the mold";
  discrete Integer seed[3](start = {1, 17, 257}, each fixed = true) "Seeds of the noise generators";
equation
  when sample(0.0, controller.sample_period) then
    for i in 1:3 loop
      seed[i] = mod(16807*pre(seed[i]), 65521);
    end for;
  end when;
  normal = {controller.normal_x, controller.normal_y, controller.normal_z};
  desired = {controller.desired_x, controller.desired_y, controller.desired_z};
  depth = max(0.0, (desired - position)*normal + higher);
  slide = velocity - (velocity*normal)*normal;
  force = stiffness*depth*(normal - friction*slide/sqrt(slide*slide + 1e-6));
  der(position) = velocity;
  der(velocity) = acceleration;
  der(acceleration) = natural^2*({controller.velocity_x, controller.velocity_y, controller.velocity_z} - velocity)
    - 2.0*damping*natural*acceleration;
  controller.position_x = position[1];
  controller.position_y = position[2];
  controller.position_z = position[3];
  // uniform noise with the same standard deviation
  controller.force_x = force[1] + noise*sqrt(12.0)*(seed[1]/65521.0 - 0.5);
  controller.force_y = force[2] + noise*sqrt(12.0)*(seed[2]/65521.0 - 0.5);
  controller.force_z = force[3] + noise*sqrt(12.0)*(seed[3]/65521.0 - 0.5);
  controller.feed_override = 1.0;
  controller.force_override = 1.0;
  controller.enable = time > 0.01;
  controller.estop = false;
  controller.commission = false;
  controller.reset_fault = false;
  annotation (
    experiment(StopTime = 12.0, Interval = 1e-3, Tolerance = 1e-8),
    Documentation(info = "<html><p>The mold lies slightly above the path of the controller. The ball approaches, polishes along
      the path with 5 N and retracts. The cycle ends in state 7, <code>Done</code>.</p></html>"));
end Mold;
