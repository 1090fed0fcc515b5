within MachiningFMUs;
package Examples "Closed loops with the essentials of a machine"
  annotation (Documentation(info = "<html><p>One for each controller. Their equations were simulated with the FMUs by another program, with
    the documented results. As Modelica they were parsed and resolved, but not run.</p></html>"));
end Examples;
