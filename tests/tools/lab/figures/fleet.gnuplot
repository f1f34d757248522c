# A fleet over time: sessions above, servers in the middle, clients that wait for a server below, at their most from second
# to second.
title = 'Clients that arrive at a fleet, and a node that fails'
# Until few sessions are left: the last clients of a random stay leave late.
stats data using (column('sessions')) name 'S' nooutput
stats data using (column('sessions') > S_max / 10 ? column('time_s') : NaN) name 'T' nooutput
wait_most = wait_s = 0
stats data using (column('waiting') > wait_most ? (wait_most = column('waiting'), wait_s = column('time_s'), 0) : 0) nooutput
subtitle = sprintf('each second of virtual time; at %g s %d clients are without a server', wait_s, wait_most)

eval(begin_head)
left_px = 70
right_px = width - 30
row_px = 216
top = head_px + 30
low = top + 2 * row_px + 24
height = low + row_px - 44 + axis_px
eval(begin(width, height))
set multiplot
eval(show_head)
set yrange [0:*]
set xrange [0:T_max]
set xtics format ''
eval(panel('Sessions', left_px, top, right_px, top + row_px - 44))
plot data using (column('time_s')):(column('sessions')) with lines linewidth 1.8 linecolor rgb blue
eval(hide_head)
panel_names = '"in use" "waiting for clients" starting'
panel_hues = green.' '.orange.' '.violet
set xtics format '%g'
eval(panel('Servers', left_px, top + row_px, right_px, top + 2 * row_px - 44))
plot data using (column('time_s')):(column('in_use')) with lines linewidth 1.8 linecolor rgb green, \
    data using (column('time_s')):(column('ready')) with lines linewidth 1.5 linecolor rgb orange, \
    data using (column('time_s')):(column('starting')) with lines linewidth 1.5 linecolor rgb violet
panel_names = panel_hues = ''
set xlabel 'time [s]' textcolor rgb ink
set yrange [0:wait_most > 0 ? 1.15 * wait_most : 1]
set xrange [wait_s - 10:wait_s + 10]
set style fill solid noborder
set xtics 2
eval(panel(sprintf('Clients without a server, second by second about %g s', wait_s), left_px, low, right_px, \
    low + row_px - 44))
plot data using (column('time_s')):(column('waiting')):(0.8) with boxes linecolor rgb red, \
    data using (column('time_s')):(column('waiting') > 0 && abs(column('time_s') - wait_s) < 10 ? column('waiting') : NaN): \
        (sprintf('%d', column('waiting'))) with labels offset 0, 0.6 textcolor rgb ink
unset multiplot
