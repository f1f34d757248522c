# A fleet over time: sessions above, servers in the middle, clients that wait for a server below.
title = 'Clients that arrive at a fleet, and a node that fails'
subtitle = 'sessions and servers, each second of virtual time'

# Until few sessions are left: the last clients of a random stay leave late.
stats data using (column('sessions')) name 'S' nooutput
stats data using (column('sessions') > S_max / 10 ? column('time_s') : NaN) name 'T' nooutput

height = 760
eval(begin(900, height))
set output name.'.png'
set multiplot
eval(show_title)
set lmargin at screen 0.10
set rmargin at screen 0.97
set key top left Left reverse samplen 2
set yrange [0:*]
set xrange [0:T_max]
set format x ''
set tmargin at screen from_top(head_px + 10)
set bmargin at screen from_top(head_px + 220)
set ylabel 'sessions' offset 0.5,0 textcolor rgb ink
plot data using (column('time_s')):(column('sessions')) with lines linewidth 1.8 linecolor rgb blue notitle
unset label 1
unset label 2
set tmargin at screen from_top(head_px + 240)
set bmargin at screen from_top(head_px + 450)
set ylabel 'servers'
plot data using (column('time_s')):(column('in_use')) with lines linewidth 1.8 linecolor rgb green title 'in use', \
    data using (column('time_s')):(column('ready')) with lines linewidth 1.5 linecolor rgb orange title 'waiting for clients', \
    data using (column('time_s')):(column('starting')) with lines linewidth 1.5 linecolor rgb violet title 'starting'
set tmargin at screen from_top(head_px + 470)
set bmargin at screen from_top(height - 56)
set format x '%g'
set xlabel 'time [s]' textcolor rgb ink
set ylabel 'clients without a server'
plot data using (column('time_s')):(column('waiting')) with lines linewidth 1.8 linecolor rgb red notitle
unset multiplot
