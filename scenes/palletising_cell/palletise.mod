MODULE Palletise
    ! Three cartons from the infeed to the pallet; the tool's z axis is its approach.
    PERS tooldata grip:=[TRUE,[[150,0,0],[0.707106781,0,0.707106781,0]],[1,[50,0,0],[1,0,0,0],0,0,0]];
    CONST jointtarget home:=[[0,-20,3,0,107,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget pick_1:=[[550,-550,390.5],[0,0,1,0],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget pick_2:=[[550,-400,390.5],[0,0,1,0],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget pick_3:=[[550,-250,390.5],[0,0,1,0],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget place_1:=[[500,250,190.5],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget place_2:=[[500,400,190.5],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget place_3:=[[640,250,190.5],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget middle:=[[550,30,600],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

    PROC main()
        MoveAbsJ home,v500,fine,grip;
        MoveJ Offs(pick_1,0,0,140),v500,fine,grip;
        bring pick_1,place_1;
        bring pick_2,place_2;
        bring pick_3,place_3;
        MoveAbsJ home,v500,fine,grip;
    ENDPROC

    PROC bring(robtarget pick,robtarget place)
        MoveL Offs(pick,0,0,140),v500,fine,grip;
        MoveL pick,v200,fine,grip;
        SetDO gripper_closed,1;
        WaitTime 0.5;
        MoveL Offs(pick,0,0,220),v200,z20,grip;
        MoveL middle,v500,z20,grip;
        MoveL Offs(place,0,0,420),v500,z20,grip;
        MoveL place,v200,fine,grip;
        SetDO gripper_closed,0;
        WaitTime 0.5;
        MoveL Offs(place,0,0,420),v200,z20,grip;
        MoveL middle,v500,fine,grip;
    ENDPROC
ENDMODULE
