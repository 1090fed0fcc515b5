within MachiningFMUs;
package Examples "Closed loops with the essentials of a machine"
  annotation (Documentation(info = "<html><p>One for each controller. Their equations were simulated beside the FMUs by another program, with
    the results that each example tells; as Modelica they were read and resolved, but not run.</p></html>"));
end Examples;
