LM=two
0.0 0.5
