# Force over speed of each slide: a panel for each joint, the bounds as a line below.
title = 'Slides with constant force'
subtitle = 'mean force over mean speed of each slide, above the line of the bounds: friction + damping x speed'
joints = unit_v = unit_f = ''
stats data using (joints = with_item(joints, strcol('joint')), unit_v = strcol('speed_unit'), \
    unit_f = strcol('force_unit'), 0) nooutput

panels = words(joints)
width = panels > 1 ? 120 + 340 * panels : 740
eval(begin_head)
eval(add_key('forwards', blue, 7))
eval(add_key('backwards', orange, 6))
eval(add_key('lower bounds', red, 0))
top = head_px + 30
height = top + 302 + axis_px
eval(begin(width, height))
set multiplot
eval(show_head)
set yrange [0:*]
set xrange [0:*]
panel_px = (width - edge_px) / real(panels) - 70
of(joint, direction) = strcol('joint') eq joint && strcol('direction') eq direction
do for [p = 1:panels] {
  joint = word(joints, p)
  x_px = 60 + (p - 1) * (panel_px + 70)
  eval(panel('joint '.joint.': force ['.unit_f.']', x_px, top, x_px + panel_px, height - axis_px))
  set xlabel 'speed ['.unit_v.']' textcolor rgb ink
  stats data using (strcol('joint') eq joint ? column('damping') : NaN) name 'D' nooutput
  stats data using (strcol('joint') eq joint ? column('friction') : NaN) name 'C' nooutput
  plot C_max + D_max * x with lines linewidth 1.5 linecolor rgb red, \
      data using (of(joint, '1') ? column('speed') : NaN):(column('force')) with points pointtype 7 pointsize 0.8 \
          linecolor rgb blue, \
      data using (of(joint, '-1') ? column('speed') : NaN):(column('force')) with points pointtype 6 pointsize 0.8 \
          linecolor rgb orange
  eval(hide_head)
}
unset multiplot
