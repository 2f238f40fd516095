step,time_s
1,0.4
