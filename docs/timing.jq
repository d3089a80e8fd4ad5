# Of the files cross-validation.json of all folds, by data set: people, error by timing alone, raw error
# (docs/results.md, "What keeps myo-rps and roshambo from their goals").
[.[].development[] | select(.gate and .score.look_ahead == "all-rows") | .score | (.events.subjects | map({(.subject): .flicker.seconds}) | add) as $seconds
  | .reference[2].subjects[] | select(.offsets | length > 0)
  | {set: (.subject | split("/")[0]), error: (1 - .raw_accuracy),
     timing: ((.offsets | map(fabs) | add / length) * .events / (200 * $seconds[.subject]))}]
| group_by(.set)[] | [.[0].set, length, (map(.timing) | add / length), (map(.error) | add / length)] | @tsv
