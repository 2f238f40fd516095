Include "exit.geo";
