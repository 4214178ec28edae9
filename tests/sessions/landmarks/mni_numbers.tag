MNI Tag Point File
Volumes = 2;
Points =
 0 0.5 0.5 "foot";
