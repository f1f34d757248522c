# What a finer setting costs and brings: the error at the device behind each network, and what it comes from.
title = 'Error of the force at the device, for each setting and round trip'
subtitle = subtitle.'; below: median time of a step; ring: least error; cross: failed'
settings = trips = ''
stats data using (settings = with_item(settings, strcol('setting')), \
    trips = with_item(trips, strcol('round_trip_ms')), 0) nooutput
# Zero has no place on a logarithmic axis.
percent(ratio) = ratio > 1e-6 ? 100 * ratio : 1e-4
has_velocities = 0
least = 1e9
most = 0
seen(value) = (least = value < least ? value : least, most = value > most ? value : most, 0)
stats data using (seen(percent(column('error'))) + seen(percent(column('error_at_states'))) + \
    (column('velocity_error_at_states') > 0 ? \
        (has_velocities = 1, seen(percent(column('velocity_error_at_states')))) : 0)) nooutput

parts = words(trips) > 1 ? 2 : 1
part_px = 240
height = head_px + 370 + parts * part_px + 20
eval(begin(1000, height))
set output name.'.png'

x(setting) = place_of(settings, setting)
behind(i) = strcol('round_trip_ms') eq word(trips, i)
has_failed(unused) = column('failed') > 0
error_of(column_name, i, failed) = behind(i) && has_failed(0) == failed ? percent(column(column_name)) : NaN
step_time(us) = us < 1000 ? sprintf('%.3g µs', us) : sprintf('%.3g ms', us / 1000)

set multiplot
eval(show_title)
set lmargin at screen 0.08
set rmargin at screen 0.98
set xrange [0.5:words(settings) + 0.5]
set xtics scale 0 ()
set tmargin at screen from_top(head_px + 30)
set bmargin at screen from_top(head_px + 320)
eval(key_above)
set logscale y
set yrange [least / 1.3:most * 1.3]
set ytics ()
set format y '%g'
do for [power = -4:5] { set for [digit in (most > 1e4 * least ? '1' : '1 2 5')] ytics add (digit * 10.**power) }
set ylabel 'E_dev [%]'
plot for [t = 1:words(trips)] data using (x(strcol('setting'))):(error_of('error', t, 0)): \
        xticlabels(strcol('setting')."\n".step_time(column('step_us'))) with linespoints pointtype 7 pointsize 0.9 \
        linewidth 1.6 linecolor rgb colour_of_network(t) title 'behind '.word(trips, t).' ms', \
    data using (x(strcol('setting'))):(error_of('error_at_states', 1, 0)) with lines linewidth 1.6 dashtype 2 \
        linecolor rgb quiet title 'model alone', \
    for [v = 1:has_velocities] data using (x(strcol('setting'))):(error_of('velocity_error_at_states', 1, 0)) \
        with lines linewidth 1.6 dashtype 4 linecolor rgb violet title 'its velocities', \
    for [t = 1:words(trips)] data using (x(strcol('setting'))):(error_of('error', t, 1)) with points pointtype 2 \
        pointsize 1.4 linewidth 2 linecolor rgb colour_of_network(t) notitle, \
    for [t = 1:words(trips)] data using (x(strcol('setting'))): \
        (column('least_error') > 0 ? error_of('error', t, 0) : NaN) with points pointtype 6 pointsize 2.2 linewidth 2 linecolor rgb colour_of_network(t) notitle

unset label 1; unset label 2
unset logscale y
set autoscale y
set format y
set ytics autofreq
set ylabel 'part of E_dev [%]'
set style fill solid noborder
set xzeroaxis linetype 1 linecolor rgb grey
part_names = 'model extrapolation age hold bounding'
part_colours = '#0b5fa5 #1a8754 #d9730d #8c6d46 #7b4fa3'
do for [part = 1:parts] {
  # The nearest network and the farthest.
  t = part == 1 ? 1 : words(trips)
  set tmargin at screen from_top(head_px + 370 + (part - 1) * part_px + 30)
  set bmargin at screen from_top(head_px + 370 + part * part_px - 30)
  set label 10 'Parts of the error behind '.word(trips, t).' ms' at graph 0, graph 1 \
      left offset 0, 0.8 font 'DejaVu Sans Bold,11' textcolor rgb ink
  plot for [i = 1:words(part_names)] data using (x(strcol('setting')) + (i - 3) * 0.16): \
      (behind(t) ? 100 * column(word(part_names, i)) : NaN):(0.14) with boxes linecolor rgb word(part_colours, i) \
      title word(part_names, i), \
      data using (x(strcol('setting'))):(NaN):xticlabels(strcol('setting')) with points notitle
}
unset multiplot
