(define (stream table)
  (:stream sample-grasp
    :inputs (?o) :domain (Item ?o)
    :outputs (?g) :certified (Grasp ?o ?g))

  (:stream sample-pose
    :inputs (?o - can ?p - place)
    :domain (and (Item ?o) (and))
    :outputs (?q - pose)
    :certified (and (Pose ?o ?q ?p) (Pose ?o ?q bin)))

  (:stream plan-motion ; nothing is asked of its inputs
    :inputs (?from ?to)
    :fluents (AtPose InHand)
    :outputs (?t)
    :certified (Motion ?from ?to ?t))

  (:stream test-clear
    :inputs (?t - path ?o)
    :domain (Item ?o)
    :certified (Clear ?t ?o)))
