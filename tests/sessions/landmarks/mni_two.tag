MNI Tag Point File
Volumes = 2;
%a comment

Points =
 0 0.5 0.5 0 0.5 0.5 "foot"
 3 0.5 0.5 3 0.5 0.5 0 1 1 "mid"
 6 0.5 0.5 5 2.5 0.5 "tip";
