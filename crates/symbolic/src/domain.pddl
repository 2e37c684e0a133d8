; Pick and place among clutter, after section V-C of the paper. What streams certify does not change; streams.pddl
; says how it is found. A way (?w) is a posture that holds the object, with the motion by which the hand comes to it
; and draws back; a motion (?m) leads from where one way ends to where another begins, the object in hand.
(define (domain pick-and-place)
  (:requirements :adl :derived-predicates)
  (:types
    support grasp pose way motion - object
    item place shelf - support)
  (:predicates
    ; given by the scene
    (Home ?o - item ?p - pose)                                   ; where it stands at first
    (Surface ?s - support)                                       ; things may be put down there
    (Stackable ?o - item ?below - item)                          ; the goal has one on the other
    ; certified by streams
    (Grasp ?o - item ?g - grasp)
    (Pose ?o - item ?p - pose)
    (Supported ?o - item ?p - pose ?s - support)                 ; at ?p it is on ?s
    (Rests ?o - item ?p - pose ?below - item ?pb - pose)         ; ?p needs ?below at ?pb
    (Kin ?o - item ?p - pose ?g - grasp ?w - way)
    (Motion ?o - item ?g - grasp ?from - way ?m - motion ?to - way)
    (CFreeWay ?w - way ?o2 - item ?p2 - pose)
    (CFreePose ?o - item ?p - pose ?o2 - item ?p2 - pose)
    ; what actions change
    (AtPose ?o - item ?p - pose)
    (AtGrasp ?o - item ?g - grasp)
    (AtConf ?w - way)                                            ; the arm is where this way ends
    (On ?o - item ?s - support)
    (HandEmpty)
    ; derived
    (Clear ?o - item)
    (InPlace ?o - item))

  (:derived (Clear ?o - item)
    (forall (?above - item) (not (On ?above ?o))))
  (:derived (InPlace ?o - item)
    (exists (?p - pose) (and (Home ?o ?p) (AtPose ?o ?p))))

  (:action pick
    :parameters (?o - item ?p - pose ?g - grasp ?w - way)
    :precondition (and
      (Kin ?o ?p ?g ?w) (AtPose ?o ?p) (HandEmpty) (Clear ?o)
      (forall (?o2 - item ?p2 - pose)
        (imply (Pose ?o2 ?p2) (or (CFreeWay ?w ?o2 ?p2) (not (AtPose ?o2 ?p2))))))
    :effect (and
      (AtGrasp ?o ?g) (AtConf ?w) (not (AtPose ?o ?p)) (not (HandEmpty))
      (forall (?s - support) (not (On ?o ?s)))))

  (:action place
    :parameters (?o - item ?p - pose ?g - grasp ?from - way ?m - motion ?to - way)
    :precondition (and
      (AtGrasp ?o ?g) (AtConf ?from) (Kin ?o ?p ?g ?to) (Motion ?o ?g ?from ?m ?to)
      (forall (?below - item ?pb - pose)
        (imply (Rests ?o ?p ?below ?pb) (AtPose ?below ?pb)))
      (forall (?o2 - item ?p2 - pose)
        (imply (Pose ?o2 ?p2)
               (or (and (CFreeWay ?to ?o2 ?p2) (CFreePose ?o ?p ?o2 ?p2)) (not (AtPose ?o2 ?p2))))))
    :effect (and
      (AtPose ?o ?p) (HandEmpty) (not (AtGrasp ?o ?g)) (not (AtConf ?from))
      (forall (?s - support) (when (Supported ?o ?p ?s) (On ?o ?s))))))
