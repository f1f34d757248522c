# Force over speed of each slide: a panel for each joint, the bounds as a line below.
title = 'Slides with constant force'
subtitle = 'mean force over mean speed of each slide, above the line of the bounds: friction + damping x speed'
joints = unit_v = unit_f = ''
stats data using (joints = with_item(joints, strcol('joint')), unit_v = strcol('speed_unit'), \
    unit_f = strcol('force_unit'), 0) nooutput

panels = words(joints)
height = 460
eval(begin(panels > 1 ? 120 + 340 * panels : 740, height))
set output name.'.png'
set multiplot
eval(show_title)
eval(only_key(head_px))
plot NaN with points pointtype 7 pointsize 0.8 linecolor rgb blue title 'forwards', \
    NaN with points pointtype 6 pointsize 0.8 linecolor rgb orange title 'backwards', \
    NaN with lines linewidth 1.5 linecolor rgb red title 'lower bounds'
eval(after_key)
set ytics nomirror out scale 0.6
set tmargin at screen from_top(head_px + 44)
set bmargin at screen 0.13
set yrange [0:*]
set xrange [0:*]
of(joint, direction) = strcol('joint') eq joint && strcol('direction') eq direction
do for [p = 1:panels] {
  joint = word(joints, p)
  set lmargin at screen (p - 1 + 0.22) / panels
  set rmargin at screen (p - 0.04) / panels
  set label 10 'joint '.joint at graph 0.5, screen from_top(head_px + 30) center \
      font 'DejaVu Sans Bold,11' textcolor rgb ink
  set xlabel 'speed ['.unit_v.']' textcolor rgb ink
  set ylabel 'force ['.unit_f.']' offset 1.5,0 textcolor rgb ink
  stats data using (strcol('joint') eq joint ? column('damping') : NaN) name 'D' nooutput
  stats data using (strcol('joint') eq joint ? column('friction') : NaN) name 'C' nooutput
  plot C_max + D_max * x with lines linewidth 1.5 linecolor rgb red notitle, \
      data using (of(joint, '1') ? column('speed') : NaN):(column('force')) with points pointtype 7 pointsize 0.8 \
          linecolor rgb blue notitle, \
      data using (of(joint, '-1') ? column('speed') : NaN):(column('force')) with points pointtype 6 pointsize 0.8 \
          linecolor rgb orange notitle
}
unset multiplot
