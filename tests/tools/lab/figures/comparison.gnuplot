# Transparency and stability of each law: a row for each, a mark in it for each network.
title = 'How stiff a wall each law displays, and how still it holds the force'
subtitle = 'medians over scenes and walls, on a device with encoder, latency and late ticks'
laws = all = ''
stats data using (laws = with_item(laws, strcol('law')), all = with_item(all, strcol('network')), 0) nooutput
# Those to draw: these three, or all if one of them is missing.
networks = '"none" "delay 10ms" "delay 50ms" '
do for [network in networks] { if (!place_of(all, network)) { networks = all } }

eval(begin_head)
do for [n = 1:words(networks)] {
  eval(add_key(word(networks, n) eq 'none' ? 'no network' : word(networks, n), colour_of_network(n), 7))
}
eval(add_key('does not rest, or not passive', quiet, 2))
eval(add_key('no law is better in both', green, 6))
row_px = 8 + 11 * words(networks)
top = head_px + 30
height = top + row_px * words(laws) + axis_px
eval(begin(width, height))

line(network) = (place_of(networks, network) - (words(networks) + 1) / 2.) * 0.8 / words(networks)
y(law, network) = place_of(laws, law) + line(network)
# Zero has no place on a logarithmic axis, and what is not known is as bad as can be.
inside(value) = value < least ? least : value > highest ? highest : value
place(quantity) = strcol(quantity) eq 'nan' ? worst : inside(column(quantity))
of(network) = strcol('network') eq network
mark(sound) = sound > 0 ? 7 : 2

set multiplot
eval(show_head)
set logscale x
set format x '%g'
rows = laws
eval(show_rows)
gap_px = 48
panel_px = (width - left_px - 2 * edge_px - gap_px) / 2
do for [p = 1:2] {
  x_px = left_px + (p - 1) * (panel_px + gap_px)
  if (p == 1) {
    quantity = 'displayed_over_requested'
    least = 0.005
    worst = least
    highest = 1.2
    set xrange [0.004:1.3]
    set xtics ('≤ 0.5 %%' 0.005, '2 %%' 0.02, '5 %%' 0.05, '10 %%' 0.1, '20 %%' 0.2, '50 %%' 0.5, '100 %%' 1)
    set xlabel 'displayed over requested stiffness'
    eval(panel('Transparency: farther right is better', x_px, top, x_px + panel_px, height - axis_px))
  } else {
    quantity = 'restlessness'
    least = 0.01
    worst = highest = 3.7
    set xrange [0.008:4]
    set xtics ('≤ 0.01' 0.01, '0.05' 0.05, '0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '1' 1, '2' 2)
    set xlabel "restlessness: the force's deviation over its mean"
    set ytics format '' ()
    eval(panel('Stability: farther left is better', x_px, top, x_px + panel_px, height - axis_px))
  }
  plot for [n = 1:words(networks)] data using (least / 10): \
          (of(word(networks, n)) ? y(strcol('law'), word(networks, n)) : NaN): \
          (place(quantity) - least / 10):(0) with vectors nohead linewidth 1 \
          linecolor rgb colour_of_network(n), \
      for [n = 1:words(networks)] data using (of(word(networks, n)) ? place(quantity) : NaN): \
          (y(strcol('law'), word(networks, n))):(mark(column('rests_and_passive'))) \
          with points pointtype variable pointsize 1 linewidth 1.5 linecolor rgb colour_of_network(n), \
      data using (column('unbeaten') > 0 && place_of(networks, strcol('network')) ? \
          place(quantity) : NaN):(y(strcol('law'), strcol('network'))) \
          with points pointtype 6 pointsize 1.9 linewidth 2 linecolor rgb green
  eval(hide_head)
}
unset multiplot
