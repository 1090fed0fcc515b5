package MachiningFMUs "Precision-machining controllers from published papers"
  annotation (
    version = "0.2.0",
    Icon(coordinateSystem(extent = {{-100, -100}, {100, 100}}), graphics = {
      Rectangle(extent = {{-100, 100}, {100, -100}}, lineColor = {0, 0, 127}, fillColor = {240, 244, 250}, fillPattern = FillPattern.Solid),
      Line(points = {{-70, -40}, {-20, -40}, {0, 40}, {70, 40}}, color = {0, 0, 127}, thickness = 1)}),
    Documentation(info = "<html><p>Each block runs a controller by its C library, as an external object: it needs no FMI in the tool, only
      a C compiler. The controller computes at its own sample period; its commands act at the instant of their sample, so
      <code>io_delay</code> is 0. Messages of the controller appear in the log of the simulation.</p>
      <p><code>cargo xtask c --modelica</code> writes blocks, headers and libraries from the declaration of the variables.</p></html>"));
end MachiningFMUs;
