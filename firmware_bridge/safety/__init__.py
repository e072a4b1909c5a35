"""Motion permission: the snapshot, the interlocks, their evaluation and the output guard."""
