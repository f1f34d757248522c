# What a finer setting costs and brings: the error at the device behind each network, and what it comes from.
title = 'Error of the force at the device, for each setting and round trip'
subtitle = subtitle.'. Below each setting: median time of a step. Ring: least error of that round trip; cross: failed'
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

part_columns = 'model extrapolation age hold bounding'
behind(i) = strcol('round_trip_ms') eq word(trips, i)
low = high = 0
stats data using (sum [i = 1:words(part_columns)] (part = 100 * column(word(part_columns, i)), \
    behind(1) || behind(words(trips)) ? (low = part < low ? part : low, high = part > high ? part : high, 0) : 0)) nooutput

eval(begin_head)
do for [t = 1:words(trips)] { eval(add_key(word(trips, t).' ms there and back', colour_of_network(t), 7)) }
eval(add_key('the model alone', quiet, -1))
if (has_velocities) { eval(add_key('its velocities', violet, -1)) }
parts = words(trips) > 1 ? 2 : 1
part_px = 230
top = head_px + 30
height = top + 320 + parts * part_px
eval(begin(width, height))

x(setting) = place_of(settings, setting)
has_failed(unused) = column('failed') > 0
error_of(column_name, i, failed) = behind(i) && has_failed(0) == failed ? percent(column(column_name)) : NaN
step_time(us) = us < 1000 ? sprintf('%.3g µs', us) : sprintf('%.3g ms', us / 1000)

left_px = 60
set multiplot
eval(show_head)
set xrange [0.5:words(settings) + 0.5]
set xtics scale 0 ()
set logscale y
set yrange [least / 1.3:most * 1.3]
set ytics ()
set format y '%g'
do for [power = -4:5] { set for [digit in (most > 1e4 * least ? '1' : '1 2 5')] ytics add (digit * 10.**power) }
eval(panel('Error (E_dev) [%]', left_px, top, width - edge_px, top + 240))
plot for [t = 1:words(trips)] data using (x(strcol('setting'))):(error_of('error', t, 0)): \
        xticlabels(strcol('setting')."\n".step_time(column('step_us'))) with linespoints pointtype 7 pointsize 0.9 \
        linewidth 1.6 linecolor rgb colour_of_network(t), \
    data using (x(strcol('setting'))):(error_of('error_at_states', 1, 0)) with lines linewidth 1.6 dashtype 3 \
        linecolor rgb quiet, \
    for [v = 1:has_velocities] data using (x(strcol('setting'))):(error_of('velocity_error_at_states', 1, 0)) \
        with lines linewidth 1.6 dashtype 3 linecolor rgb violet, \
    for [t = 1:words(trips)] data using (x(strcol('setting'))):(error_of('error', t, 1)) with points pointtype 2 \
        pointsize 1.4 linewidth 2 linecolor rgb colour_of_network(t), \
    for [t = 1:words(trips)] data using (x(strcol('setting'))): \
        (column('least_error') > 0 ? error_of('error', t, 0) : NaN) with points pointtype 6 pointsize 2.2 linewidth 2 \
        linecolor rgb colour_of_network(t)
eval(hide_head)

unset logscale y
set format y
set ytics autofreq
set style fill solid noborder
set xzeroaxis linetype 1 linecolor rgb grey
panel_hues = '#0b5fa5 #1a8754 #d9730d #8c6d46 #7b4fa3'
panel_names = part_columns
set yrange [1.05 * low:high > low ? 1.05 * high : 1]
do for [part = 1:parts] {
  # The nearest network and the farthest.
  t = part == 1 ? 1 : words(trips)
  y_px = top + 320 + (part - 1) * part_px
  eval(panel('Parts of it at '.word(trips, t).' ms [%]', left_px, y_px, width - edge_px, y_px + part_px - 66))
  plot for [i = 1:words(part_columns)] data using (x(strcol('setting')) + (i - 3) * 0.16): \
      (behind(t) ? 100 * column(word(part_columns, i)) : NaN):(0.14) with boxes linecolor rgb word(panel_hues, i), \
      data using (x(strcol('setting'))):(0):xticlabels(strcol('setting')) with points pointsize 0
}
unset multiplot
