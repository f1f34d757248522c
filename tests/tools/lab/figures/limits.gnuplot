# The stiffest wall that comes to rest: a panel for each hand, a row for each law, a mark in it for each delay.
title = 'The stiffest virtual wall that comes to rest'
subtitle = 'a row for each law, a line in it for each delay t each way; ideal device, b = 30 N s/m, T = 1 ms; '. \
    'triangle: all up to 1000 N/mm; cross: not even 0.1 N/mm'
theories = "'2b/T' 'b/(T/2 + 2t)'"
hands = laws = delays = ''
stats data using (hands = with_item(hands, strcol('hand')), delays = with_item(delays, strcol('delay_ms')), \
    laws = strstrt(theories, "'".strcol('law')."'") ? laws : with_item(laws, strcol('law')), 0) nooutput

eval(begin_head)
do for [d = 1:words(delays)] { eval(add_key('t = '.word(delays, d).' ms', colour_of_network(d), 7)) }
eval(add_key('2b/T', ink, 0))
eval(add_key('b/(T/2 + 2t)', quiet, -1))
row_px = 8 + 9 * words(delays)
top = head_px + 30
height = top + row_px * words(laws) + axis_px
eval(begin(width, height))

# Beyond what was tried: marks on the edges.
least = 0.05
most = 1000.
inside(stiffness) = stiffness < least ? least : stiffness
mark(stiffness) = stiffness >= most ? 9 : stiffness < least ? 2 : 7
line(delay) = (place_of(delays, delay) - (words(delays) + 1) / 2.) * 0.8 / words(delays)
y(law, delay) = place_of(laws, law) + line(delay)
stiffness(hand, delay, law) = strcol('hand') eq hand && strcol('delay_ms') eq delay && strcol('law') eq law ? \
    column('stiffness_N_per_mm') : NaN
of(hand, delay) = strcol('hand') eq hand && strcol('delay_ms') eq delay && place_of(laws, strcol('law')) > 0

set multiplot
eval(show_head)
set logscale x
set xrange [0.035:1600]
set format x '%g'
set xtics (0.1, 1, 10, 100, 1000)
set xlabel 'stiffness of the wall [N/mm]'
rows = laws
eval(show_rows)
panel_px = (width - left_px - edge_px) / real(words(hands)) - 20
do for [h = 1:words(hands)] {
  hand = word(hands, h)
  x_px = left_px + (h - 1) * (panel_px + 20)
  eval(panel('Under a '.hand.' hand', x_px, top, x_px + panel_px, height - axis_px))
  if (h == 2) { set ytics format '' () }
  plot for [d = 1:words(delays)] data using (inside(stiffness(hand, word(delays, d), 'b/(T/2 + 2t)'))):(0.5): \
          (0):(words(laws)) with vectors nohead linewidth 1.5 dashtype 3 linecolor rgb colour_of_network(d), \
      data using (stiffness(hand, word(delays, 1), '2b/T')):(0.5):(0):(words(laws)) with vectors nohead \
          linewidth 1.5 linecolor rgb ink, \
      for [d = 1:words(delays)] data using (least / 10): \
          (of(hand, word(delays, d)) ? y(strcol('law'), word(delays, d)) : NaN): \
          (inside(column('stiffness_N_per_mm')) - least / 10):(0) with vectors nohead linewidth 1 \
          linecolor rgb colour_of_network(d), \
      for [d = 1:words(delays)] data using (of(hand, word(delays, d)) ? inside(column('stiffness_N_per_mm')) : NaN): \
          (y(strcol('law'), word(delays, d))):(mark(column('stiffness_N_per_mm'))) with points pointtype variable \
          pointsize 0.8 linecolor rgb colour_of_network(d)
  eval(hide_head)
}
unset multiplot
