MNI Tag Point File
Volumes = 1;
Points = 0 0.5 0.5 ""
 3 0.5 0.5 0 -1 -1;
