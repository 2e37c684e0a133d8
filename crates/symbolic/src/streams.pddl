; What Clearway finds for pick-and-place. Names, and how many inputs and outputs there are, are the program's; what
; they need and what they certify can be changed, and whole streams left out.
(define (stream pick-and-place)
  (:stream sample-grasp
    :inputs (?o - item)
    :outputs (?g - grasp)
    :certified (Grasp ?o ?g))

  (:stream sample-placement
    :inputs (?o - item ?g - grasp ?s - support)
    :domain (and (Grasp ?o ?g) (Surface ?s))
    :outputs (?p - pose)
    :certified (and (Pose ?o ?p) (Supported ?o ?p ?s)))

  (:stream sample-stacking
    :inputs (?o - item ?g - grasp ?below - item ?pb - pose)
    :domain (and (Stackable ?o ?below) (Grasp ?o ?g) (Pose ?below ?pb))
    :outputs (?p - pose)
    :certified (and (Pose ?o ?p) (Supported ?o ?p ?below) (Rests ?o ?p ?below ?pb)))

  (:stream inverse-kinematics
    :inputs (?o - item ?p - pose ?g - grasp)
    :domain (and (Pose ?o ?p) (Grasp ?o ?g))
    :outputs (?w - way)
    :certified (Kin ?o ?p ?g ?w))

  (:stream plan-motion
    :inputs (?o - item ?g - grasp ?p1 - pose ?from - way ?p2 - pose ?to - way)
    :domain (and (Kin ?o ?p1 ?g ?from) (Kin ?o ?p2 ?g ?to))
    :fluents (AtPose)
    :outputs (?m - motion)
    :certified (Motion ?o ?g ?from ?m ?to))

  (:stream test-cfree-way
    :inputs (?w - way ?o2 - item ?p2 - pose)
    :domain (Pose ?o2 ?p2)
    :certified (CFreeWay ?w ?o2 ?p2))

  (:stream test-cfree-pose
    :inputs (?o - item ?p - pose ?o2 - item ?p2 - pose)
    :domain (and (Pose ?o ?p) (Pose ?o2 ?p2))
    :certified (CFreePose ?o ?p ?o2 ?p2)))
