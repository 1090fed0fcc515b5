"""The controllers without FMI: C libraries, and blocks of Modelica that call them."""
