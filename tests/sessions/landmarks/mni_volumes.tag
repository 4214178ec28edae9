MNI Tag Point File
Volumes = 3;
Points =
 0 0 0;
