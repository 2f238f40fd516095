// SystemCall in a comment is none
SystemCall "touch called";
Merge "rectangle.geo";
