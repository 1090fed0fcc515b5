within MachiningFMUs;
package Examples "Closed loops with the essentials of a machine"
end Examples;
