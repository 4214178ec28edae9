MNI Tag Point File
Volumes = 2;
